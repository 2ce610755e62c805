#include "runner/heat_land.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/accuracy/quantities.h"
#include "core/base/hottest.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/geo/frames.h"
#include "core/land/kinds/land_below_target.h"
#include "core/land/kinds/make_land_kinds.h"
#include "core/thermal/land/land_heat.h"
#include "messages/inputs/moved_sweep.h"
#include "messages/scene/land_heat_messages.h"
#include "messages/scene/scene_from_message.h"
#include "runner/heat_walls.h"
#include "runner/heat_weather.h"

namespace irsig {
namespace {

// Places of each material that show how well its kinds stand for it.
constexpr std::uint32_t kHeldOutPlaces = 48;

// The target may drive through the wind, the land does not.
absl::StatusOr<HeatKnots> weather_of_land(const schema::Sweep& sweep, const schema::HeatRun& heat) {
  if (sweep.place().speed_m_s() == 0) return heat_weather(sweep, heat);
  schema::Sweep at_rest = sweep;
  at_rest.mutable_place()->set_speed_m_s(0);
  return heat_weather(at_rest, heat);
}

absl::StatusOr<LandHeatMaterial> material_of(const schema::Sweep& sweep, int m,
                                             std::uint32_t material,
                                             const std::vector<WallBuildUp>& walls,
                                             std::vector<std::string>& warning) {
  ASSIGN_OR_RETURN(const auto surface,
                   heat_surface(sweep.material(static_cast<int>(material)),
                                absl::StrCat("material[", material, "]"), warning));
  const std::string& name = sweep.land().material(m).build_up();
  for (const WallBuildUp& wall : walls)
    if (wall.name == name)
      return LandHeatMaterial{wall, surface.solar_absorptance, surface.emissivity};
  return keyed_problem(absl::StrCat("land.material[", m, "].build_up"),
                       absl::StrCat("= \"", name, "\" is no [[build_up]]"));
}

absl::Status check_land_kelvin(const schema::Sweep& sweep, const schema::HeatRun& heat,
                               const LandKinds& kinds, const LandHeatResult& by_time) {
  for (std::size_t o = 0; o < by_time.kelvin.size(); ++o)
    for (std::size_t k = 0; k < kinds.kind.size(); ++k) {
      const float kelvin = by_time.kelvin[o][k];
      if (kelvin > 0 && static_cast<double>(kelvin) <= kHottestK) continue;
      const auto m = static_cast<int>(kinds.kind[k].material);
      const schema::LandMaterial& material = sweep.land().material(m);
      return keyed_problem(
          absl::StrCat("land.material[", m, "].build_up"),
          absl::StrCat("= \"", material.build_up(), "\": \"", material.material(),
                       "\" would be at ", kelvin, " K at ", heat.time_utc(static_cast<int>(o)),
                       ": no weather makes up for what the build_up says of its inside"));
    }
  return absl::OkStatus();
}

// Request of one run, and the outputs at which the wanted times stand.
struct AskedOfLand {
  LandHeatRequest request;
  std::vector<std::size_t> output_of_time;
};
absl::StatusOr<AskedOfLand> asked_of_land(const schema::Sweep& sweep, const schema::HeatRun& heat,
                                          std::vector<std::string>& warning) {
  AskedOfLand out;
  LandHeatRequest& request = out.request;
  ASSIGN_OR_RETURN(auto weather, weather_of_land(sweep, heat));
  ASSIGN_OR_RETURN(const auto walls, walls_at_knots(sweep, weather.knot_s));
  ASSIGN_OR_RETURN(const auto numbers, land_materials_from_sweep(sweep));
  std::vector<std::string> odd;
  for (int m = 0; m < sweep.land().material_size(); ++m) {
    const double stated_k = heat.land_temperature_k(m);
    request.stated_k.push_back(stated_k);
    request.material.emplace_back();
    if (stated_k > 0) continue;
    ASSIGN_OR_RETURN(request.material.back(),
                     material_of(sweep, m, numbers[static_cast<std::size_t>(m)], walls, odd));
  }
  for (std::string& text : odd)
    if (std::find(warning.begin(), warning.end(), text) == warning.end())
      warning.push_back(std::move(text));
  request.knot_s = std::move(weather.knot_s);
  request.weather = std::move(weather.at);
  request.day_knots = weather.day_knots;
  // All that are known: the target sees the land at each of them.
  for (std::size_t k = 0; k < request.knot_s.size(); k += 2) request.output_knot.push_back(k);
  request.heading_deg = sweep.place().heading_deg();
  request.tolerance_k = sweep.heat().tolerance_k();
  if (heat.has_sky_factor())
    for (HeatWeather& at : request.weather)
      for (HeatRadiation* radiation : {&at.before, &at.after})
        radiation->sky_w_m2 *= heat.sky_factor();
  if (heat.has_convection_factor()) request.convection_factor = heat.convection_factor();
  for (const std::size_t o : weather.output_of_time)
    out.output_of_time.push_back(weather.output_knot[o] / 2);
  return out;
}

}  // namespace

std::size_t most_land_kinds(const schema::Sweep& sweep) {
  LandKinds kinds;
  kinds.materials = static_cast<std::uint32_t>(sweep.land().material_size());
  kinds.computed = land_computed(sweep);
  kinds.on_objects = land_on_objects(sweep);
  kinds.horizon.resize(kMostLandHorizons);
  kinds.index_kinds();
  return kinds.kind.size();
}

absl::StatusOr<schema::LandHeat> compute_land_heat(const schema::Sweep& sweep,
                                                   const schema::HeatRun& heat,
                                                   const LandScene& land,
                                                   std::vector<std::string>& warning,
                                                   LandCourse& course) {
  ASSIGN_OR_RETURN(const AskedOfLand asked, asked_of_land(sweep, heat, warning));
  const LandKinds kinds =
      make_land_kinds(land, land_computed(sweep), land_on_objects(sweep), kHeldOutPlaces);
  auto solved = solve_land_heat(kinds, asked.request);
  if (!solved.ok()) return at_key("land", solved.status());
  // Times of several days may share a knot of the one that repeats.
  LandHeatResult by_time;
  for (const std::size_t k : asked.output_of_time) {
    by_time.kelvin.push_back(solved->kelvin[k]);
    by_time.error_k.push_back(solved->error_k[k]);
    by_time.interpolation_k.push_back(solved->interpolation_k[k]);
  }
  RETURN_IF_ERROR(check_land_kelvin(sweep, heat, kinds, by_time));
  schema::LandHeat out = land_heat_to_message(kinds, by_time);
  course = {kinds, std::move(solved->kelvin)};
  return out;
}

absl::StatusOr<LandChangesOfRun> compute_land_changes(const schema::ResolvedSweep& resolved,
                                                      const schema::HeatRun& heat,
                                                      const LandScene& land) {
  const schema::Sweep& sweep = resolved.sweep();
  std::vector<std::string> said;  // by the run whose temperatures change
  ASSIGN_OR_RETURN(const AskedOfLand asked, asked_of_land(sweep, heat, said));
  schema::ResolvedSweep alone;  // what land depends on
  *alone.mutable_sweep() = sweep;
  *alone.add_heat() = heat;
  std::vector<LandHeatRequest> moved;
  std::vector<int> input_of;  // of `moved`
  for (int i = 0; i < heat.input_size(); ++i) {
    const schema::InputMove& input = heat.input(i);
    const MovedSweep other = moved_sweep(alone, {input.name(), input.sigma()}, input.move());
    if (!moves_land(alone, other.sweep, 0)) continue;
    auto request = asked_of_land(other.sweep.sweep(), other.sweep.heat(0), said);
    if (!request.ok()) return at_key(absl::StrCat("uncertainty.", input.name()), request.status());
    request->request.of_model = is_of_heat_model(input.name());
    moved.push_back(std::move(request->request));
    input_of.push_back(i);
  }
  LandChangesOfRun out;
  LandKinds& kinds = out.course.kinds;
  kinds = make_land_kinds(land, land_computed(sweep), land_on_objects(sweep), 0);
  auto changes = solve_land_heat_changes(kinds, asked.request, moved);
  if (!changes.ok()) return at_key("land", changes.status());
  out.course.kelvin = std::move(changes->kelvin);
  const std::string none(sizeof(float) * kinds.kind.size() * asked.output_of_time.size(), '\0');
  const auto inputs = static_cast<std::size_t>(heat.input_size());
  out.change_k.assign(inputs, none);
  out.difference_k.resize(inputs);
  for (std::size_t i = 0; i < input_of.size(); ++i) {
    const auto input = static_cast<std::size_t>(input_of[i]);
    out.difference_k[input] = std::move(changes->moved[i].difference_k);
    std::string& to = out.change_k[input];
    to.clear();
    for (const std::size_t k : asked.output_of_time) {
      const std::vector<float>& row = changes->moved[i].change_k[k];
      to.append(reinterpret_cast<const char*>(row.data()), sizeof(float) * row.size());
    }
  }
  return out;
}

std::vector<double> ground_around_k(const LandScene& land, const LandCourse& course,
                                    const std::vector<std::vector<float>>& difference_k,
                                    const Mesh& mesh, double surface_z_m,
                                    const std::vector<double>& knot_s) {
  Vec<Body> low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
  for (const Vec<Body>& v : mesh.vertex) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  const Vec<Enu> middle = enu_from_body(0.5 * (low + high), land.heading_deg);
  constexpr double kLeastAboveM = 0.01;
  const TargetOnLand target{middle.x, middle.y, 0.25 * (high.x - low.x + high.y - low.y),
                            std::max(surface_z_m - 0.5 * (low.z + high.z), kLeastAboveM)};
  const std::vector<KindShare> around = land_below_target(land, course.kinds, target);
  std::vector<double> out;
  if (around.empty()) return out;
  for (std::size_t t = 0; t < course.kelvin.size(); ++t) {
    double fourth = 0, share = 0;
    for (const KindShare& part : around) {
      double kelvin = static_cast<double>(course.kelvin[t][part.kind]);
      if (!difference_k.empty()) kelvin += static_cast<double>(difference_k[t][part.kind]);
      fourth += static_cast<double>(part.share) * kelvin * kelvin * kelvin * kelvin;
      share += static_cast<double>(part.share);
    }
    const double kelvin = std::sqrt(std::sqrt(fourth / share));
    if (t > 0) {
      const std::size_t k = 2 * t - 1;
      const double part = (knot_s[k] - knot_s[k - 1]) / (knot_s[k + 1] - knot_s[k - 1]);
      out.push_back(std::lerp(out.back(), kelvin, part));
    }
    out.push_back(kelvin);
  }
  return out;
}

}  // namespace irsig
