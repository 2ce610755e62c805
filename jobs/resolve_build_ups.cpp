#include <algorithm>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/thermal/solids.h"
#include "jobs/nearest_name.h"
#include "jobs/resolve.h"

namespace irsig {
namespace {

constexpr SectionCheck::Names::value_type kConductivity = "conductivity_w_m_k",
                                          kDensity = "density_kg_m3",
                                          kSpecificHeat = "specific_heat_j_kg_k";

// A layer's numbers, those of its solid written out.
void resolve_layer(schema::Layer& layer, const std::string& path, Findings& findings) {
  const SectionCheck check(layer, path, findings);
  check.require({"thickness_m"}, "expected how thick the layer is");
  if (!layer.has_solid()) {
    check.require({kConductivity, kDensity, kSpecificHeat},
                  "expected solid = \"...\" (`irsig show solids`) or all three numbers");
  } else {
    check.only({"solid", "thickness_m"}, "to a layer of a solid of the library");
    const Solid* solid = solid_named(layer.solid());
    std::vector<std::string> names;
    for (const Solid& s : solids()) names.emplace_back(s.name);
    if (solid == nullptr) {
      check.error("solid",
                  absl::StrCat("= \"", one_line(layer.solid()), "\" is not in the library, ",
                               suggestion(layer.solid(), names)));
      return;
    }
    layer.clear_solid();
    layer.set_conductivity_w_m_k(solid->conductivity_w_m_k);
    layer.set_density_kg_m3(solid->density_kg_m3);
    layer.set_specific_heat_j_kg_k(solid->specific_heat_j_kg_k);
  }
  if (layer.has_thickness_m() && layer.thickness_m() <= 0)
    check.error("thickness_m", absl::StrCat("= ", layer.thickness_m(),
                                            ", expected more than 0: a layer without "
                                            "thickness is left out"));
  else if (layer.conductivity_w_m_k() == 0 &&
           layer.density_kg_m3() * layer.specific_heat_j_kg_k() == 0 &&
           layer.has_conductivity_w_m_k())
    check.error(kConductivity,
                "= 0 in a layer that stores no heat: nothing says how warm it is, expected a "
                "conductivity, or density and specific heat");
}

void check_inside(const schema::BuildUp& build_up, const SectionCheck& check) {
  check.require({"inside"},
                "expected what its inner face meets: \"adiabatic\", \"heat_flux\", \"air\", "
                "\"temperature\" or \"open\"");
  if (!check.one_of("inside", {"adiabatic", "heat_flux", "air", "temperature", "open"})) return;
  const std::string& inside = build_up.inside();
  const auto needs = [&](const char* key, bool needed, const char* what) {
    if (needed)
      check.require({key}, absl::StrCat("expected ", what, ": inside is \"", inside, "\""));
    else if (check.has(key))
      check.error(key, absl::StrCat("does not apply to inside = \"", inside, "\""));
  };
  needs("inside_temperature_k", inside == "air" || inside == "temperature",
        "the temperature behind the wall");
  needs("inside_h_w_m2_k", inside == "air",
        "its convection and radiation, about 8 W/(m2 K) in rooms");
  needs("inside_heat_flux_w_m2", inside == "heat_flux", "the heat that goes into the wall");
}

const schema::Material* material_of(const schema::Sweep& sweep, const std::string& name) {
  for (const schema::Material& m : sweep.material())
    if (m.name() == name) return &m;
  return nullptr;
}

}  // namespace

void resolve_build_ups(schema::Sweep& sweep, Findings& findings) {
  const std::vector<std::string> names = check_names(sweep.build_up(), "build_up", findings);
  for (int b = 0; b < sweep.build_up_size(); ++b) {
    schema::BuildUp& build_up = *sweep.mutable_build_up(b);
    const std::string path = absl::StrCat("build_up[", b, "]");
    const SectionCheck check(build_up, path, findings);
    if (build_up.layer().empty())
      check.error("layer", "is missing, expected one or more layers from the outer face inwards");
    for (int l = 0; l < build_up.layer_size(); ++l)
      resolve_layer(*build_up.mutable_layer(l), absl::StrCat(path, ".layer[", l, "]"), findings);
    check_inside(build_up, check);
    const auto uses = [&](const schema::Part& p) { return p.build_up() == build_up.name(); };
    if (build_up.has_name() && std::none_of(sweep.part().begin(), sweep.part().end(), uses))
      check.error("name", absl::StrCat("= \"", one_line(build_up.name()),
                                       "\" is used by no part, expected build_up = \"",
                                       one_line(build_up.name()), "\" in one of them"));
  }
  for (int p = 0; p < sweep.part_size(); ++p) {
    const schema::Part& part = sweep.part(p);
    const SectionCheck check(part, absl::StrCat("part[", p, "]"), findings);
    if (part.has_build_up()) {
      const auto found = std::find(names.begin(), names.end(), part.build_up());
      if (found == names.end()) {
        check.error("build_up",
                    absl::StrCat("= \"", one_line(part.build_up()), "\" is no [[build_up]], ",
                                 suggestion(part.build_up(), names)));
      } else if (const auto& build_up = sweep.build_up(static_cast<int>(found - names.begin()));
                 build_up.inside() == "open" && !part.two_sided()) {
        check.error("build_up", absl::StrCat("= \"", one_line(part.build_up()),
                                             "\", whose inside is open, expected two_sided = true: "
                                             "its back is a face too"));
      }
    }
    if (!sweep.has_heat()) continue;
    const schema::Material* material = material_of(sweep, part.material());
    if (material != nullptr && !material->has_solar_absorptance())
      check.error(
          "material",
          absl::StrCat("= \"", one_line(part.material()),
                       "\" has no solar_absorptance, expected the share of sunlight (0.3 to "
                       "2.5 um) that it absorbs, in its [[material]]: temperatures are to "
                       "be computed"));
  }
  if (sweep.heat().has_element_size_m())
    for (int f = 0; f < sweep.temperature_field_size(); ++f)
      if (sweep.temperature_field(f).match() == "index")
        findings.add("heat.element_size_m",
                     absl::StrCat("heat.element_size_m cuts facets, whose numbers then are others "
                                  "than temperature_field[",
                                  f, "] counts, expected match = \"centroid\" there"));
}

}  // namespace irsig
