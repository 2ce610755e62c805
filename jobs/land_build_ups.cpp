#include "jobs/land_build_ups.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "absl/strings/str_cat.h"
#include "jobs/resolve_land.h"

namespace irsig {
namespace {

// A layer of one of the solids of core/thermal/solids.h, or of the ground below.
enum class Of { kSolid, kGravel, kMoistLoam };
struct GroundLayer {
  double thickness_m;
  Of of;
  std::string_view solid = "";
};

struct Plants {
  double leaf_area_index, stomatal_resistance_s_m;
};

struct LandBuildUp {
  std::string_view entry;
  // The entry's own emissivity from 0.3 to 2.5 um, weighted with the sun's spectrum [astm_e490].
  double solar_absorptance;
  std::vector<GroundLayer> layer;  // from the surface down
  // Moisture of the surface between plants; absent: it neither evaporates nor takes dew.
  std::optional<double> surface_moisture = {};
  std::optional<Plants> canopy = {};
};

// Depth: a day's wave of temperature falls to 1/e in 0.11 m of moist loam, and to 1/5000 in 1 m.
// Lawn: a reference surface of clipped grass, 0.12 m high, has a leaf area index of 24 x 0.12 and
// 100 s/m [allen1998, eq. 5 and box 5]. Its ground is dry: "The same field under crops in July",
// docs/explanation/methods/thermal.md. Wheat in growth: likewise, with a leaf area index of 3. Ripe
// wheat transpires little, and stands so high that the air cools it: no layer describes it.
// Road: 0.15 m of asphalt and 0.4 m of gravel, a common order of sizes and no measurement.
// Wall: a brick's length, 0.24 m.
const std::vector<LandBuildUp>& table() {
  static const auto& rows = *new std::vector<LandBuildUp>{
      {"grass", 0.80, {{1.0, Of::kMoistLoam}}, 0, Plants{2.88, 100}},
      {"wheat", 0.73, {{1.0, Of::kMoistLoam}}, 0, Plants{3, 100}},
      {"bare_soil_dry", 0.75, {{0.1, Of::kSolid, "clay_soil_dry"}, {0.9, Of::kMoistLoam}}, 0},
      {"bare_soil_wet", 0.88, {{1.0, Of::kSolid, "clay_soil_wet"}}, 1},
      {"sand", 0.63, {{1.0, Of::kSolid, "sandy_soil_dry"}}, 0},
      {"asphalt",
       0.90,
       {{0.15, Of::kSolid, "asphalt"}, {0.4, Of::kGravel}, {0.45, Of::kMoistLoam}}},
      {"concrete", 0.68, {{0.2, Of::kSolid, "concrete"}, {0.8, Of::kMoistLoam}}},
      {"brick", 0.68, {{0.24, Of::kSolid, "brick"}, {0.76, Of::kMoistLoam}}},
  };
  return rows;
}

const LandBuildUp* default_of(const std::string& entry) {
  for (const LandBuildUp& row : table())
    if (row.entry == entry) return &row;
  return nullptr;
}

schema::Layer layer_message(const GroundLayer& layer) {
  schema::Layer out;
  out.set_thickness_m(layer.thickness_m);
  const auto set = [&](double w_m_k, double kg_m3, double j_kg_k) {
    out.set_conductivity_w_m_k(w_m_k);
    out.set_density_kg_m3(kg_m3);
    out.set_specific_heat_j_kg_k(j_kg_k);
  };
  switch (layer.of) {
    case Of::kSolid:
      out.set_solid(std::string(layer.solid));
      break;
    case Of::kGravel:  // sand and gravel, middles of the ranges [iso10456, table 3]
      set(2.0, 1950, 1045);
      break;
    case Of::kMoistLoam:  // "A field in autumn", docs/explanation/methods/thermal.md
      set(1.2, 2000, 1250);
      break;
  }
  return out;
}

// Faces of objects that cover no ground have no ground behind them.
std::vector<GroundLayer> layers_of(const LandBuildUp& row, bool objects_only) {
  std::vector<GroundLayer> out;
  for (const GroundLayer& layer : row.layer)
    if (!objects_only || layer.of == Of::kSolid) out.push_back(layer);
  return out.empty() ? row.layer : out;
}

std::string free_name(const schema::Sweep& sweep, const std::string& wanted) {
  std::string name = wanted;
  const auto taken = [&](const schema::BuildUp& b) { return b.name() == name; };
  for (int i = 2; std::any_of(sweep.build_up().begin(), sweep.build_up().end(), taken); ++i)
    name = absl::StrCat(wanted, " ", i);
  return name;
}

void add_build_up(const LandBuildUp& row, schema::LandMaterial& material, schema::Sweep& sweep) {
  const std::string name = free_name(sweep, absl::StrCat("land ", material.material()));
  schema::BuildUp& out = *sweep.add_build_up();
  out.set_name(name);
  for (const GroundLayer& layer : layers_of(row, material.objects_only()))
    *out.add_layer() = layer_message(layer);
  out.set_inside("adiabatic");
  if (row.surface_moisture) out.set_surface_moisture(*row.surface_moisture);
  if (row.canopy) {
    out.mutable_canopy()->set_leaf_area_index(row.canopy->leaf_area_index);
    out.mutable_canopy()->set_stomatal_resistance_s_m(row.canopy->stomatal_resistance_s_m);
  }
  material.set_build_up(name);
}

}  // namespace

bool has_land_build_up(const std::string& entry) { return default_of(entry) != nullptr; }

void write_land_build_ups(schema::Sweep& sweep) {
  if (!sweep.has_heat() || !sweep.has_land()) return;
  for (schema::LandMaterial& material : *sweep.mutable_land()->mutable_material()) {
    const bool stated =
        std::all_of(sweep.season().begin(), sweep.season().end(),
                    [&](const schema::Season& season) { return is_stated(season, material); });
    if (stated && !material.has_build_up()) continue;
    for (schema::Material& of : *sweep.mutable_material()) {
      const LandBuildUp* row = of.name() == material.material() ? default_of(of.entry()) : nullptr;
      if (row == nullptr) continue;
      if (!of.has_solar_absorptance()) of.set_solar_absorptance(row->solar_absorptance);
      if (!material.has_build_up()) add_build_up(*row, material, sweep);
    }
  }
}

}  // namespace irsig
