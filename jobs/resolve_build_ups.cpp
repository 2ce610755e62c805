#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/hottest.h"
#include "core/geo/sun.h"
#include "core/thermal/solids.h"
#include "jobs/resolve.h"
#include "jobs/text/nearest_name.h"
#include "jobs/text/time_of_day.h"

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
  if (layer.conductivity_w_m_k() > 0) {
    check.within(kConductivity, 1e-9, 1e12);
  } else if (layer.density_kg_m3() * layer.specific_heat_j_kg_k() == 0 &&
             layer.has_conductivity_w_m_k()) {
    check.error(kConductivity,
                "= 0 in a layer that stores no heat: nothing says how warm it is, expected a "
                "conductivity, or density and specific heat");
  }
}

// No wall is so hot behind its outer face as the heat that is said to cross it would make it.
void check_heat_flux(const schema::BuildUp& build_up, const std::string& path, Findings& findings) {
  double m2_k_w = 0;
  for (const schema::Layer& layer : build_up.layer())
    if (layer.conductivity_w_m_k() > 0) m2_k_w += layer.thickness_m() / layer.conductivity_w_m_k();
  const auto check = [&](const SectionCheck& at, const char* key, double w_m2) {
    if (at.has(key) && std::abs(w_m2) * m2_k_w > kHottestK)
      at.error(key, absl::StrCat("= ", w_m2, " across layers of ", absl::SixDigits(m2_k_w),
                                 " m2 K/W is a difference of ", absl::SixDigits(w_m2 * m2_k_w),
                                 " K, expected at most ", kHottestK));
  };
  check(SectionCheck(build_up, path, findings), "inside_heat_flux_w_m2",
        build_up.inside_heat_flux_w_m2());
  for (int i = 0; i < build_up.inside_schedule_size(); ++i)
    check(SectionCheck(build_up.inside_schedule(i), absl::StrCat(path, ".inside_schedule[", i, "]"),
                       findings),
          "heat_flux_w_m2", build_up.inside_schedule(i).heat_flux_w_m2());
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
  const bool temperature = inside == "air" || inside == "temperature",
             heat_flux = inside == "heat_flux", scheduled = !build_up.inside_schedule().empty();
  if (scheduled) {
    if (!temperature && !heat_flux)
      check.error("inside_schedule", absl::StrCat("does not apply to inside = \"", inside, "\""));
    (void)check.at_most_one({"inside_temperature_k", "inside_heat_flux_w_m2", "inside_schedule"});
  } else {
    needs("inside_temperature_k", temperature,
          "the temperature behind the wall, or an inside_schedule");
    needs("inside_heat_flux_w_m2", heat_flux,
          "the heat that goes into the wall, or an inside_schedule");
  }
  needs("inside_h_w_m2_k", inside == "air",
        "its convection and radiation, about 8 W/(m2 K) in rooms");
}

// Water on the outer face; ground between plants is dry unless its moisture is stated.
void resolve_water(schema::BuildUp& build_up, const std::string& path, const SectionCheck& check,
                   Findings& findings) {
  if (build_up.inside() == "open")
    for (const char* key : {"surface_moisture", "canopy"})
      if (check.has(key))
        check.error(key,
                    "does not apply to inside = \"open\", whose inner face is in the weather too: "
                    "latent heat is of outer faces alone, expected another inside");
  if (!build_up.has_canopy()) return;
  SectionCheck(build_up.canopy(), path + ".canopy", findings)
      .require({"leaf_area_index", "stomatal_resistance_s_m"},
               "expected both numbers of the plants: canopy = { leaf_area_index = 3, "
               "stomatal_resistance_s_m = 100 } is a crop that covers the ground");
  if (!build_up.has_surface_moisture()) build_up.set_surface_moisture(0);
}

// The schedule's times, in UTC and in its order: other offsets and another first time of the same
// day are the same schedule.
void resolve_schedule(schema::BuildUp& build_up, const std::string& path, const SectionCheck& check,
                      Findings& findings) {
  auto& schedule = *build_up.mutable_inside_schedule();
  if (schedule.empty()) {
    if (build_up.has_inside_between())
      check.error("inside_between", "does not apply without inside_schedule");
    return;
  }
  if (schedule.size() > 1)
    check.require({"inside_between"},
                  "expected what holds between two times of the schedule: \"linear\" or \"steps\"");
  (void)check.one_of("inside_between", {"linear", "steps"});
  const bool heat_flux = build_up.inside() == "heat_flux",
             applies =
                 heat_flux || build_up.inside() == "air" || build_up.inside() == "temperature";
  const char *needed = heat_flux ? "heat_flux_w_m2" : "temperature_k",
             *other = heat_flux ? "temperature_k" : "heat_flux_w_m2";
  std::vector<std::pair<DayTime, schema::InsideAt>> by_time;
  for (int i = 0; i < schedule.size(); ++i) {
    const schema::InsideAt& at = schedule[i];
    const SectionCheck here(at, absl::StrCat(path, ".inside_schedule[", i, "]"), findings);
    here.require({"time"}, "expected a time of day with its offset from UTC: \"06:00+09:00\"");
    if (applies) {
      here.require({needed}, absl::StrCat("expected what is behind the wall then: inside is \"",
                                          build_up.inside(), "\""));
      if (here.has(other))
        here.error(other, absl::StrCat("does not apply to inside = \"", build_up.inside(), "\""));
    }
    if (!at.has_time()) continue;
    const auto wrong = [&](const std::string& what) {
      here.error("time", absl::StrCat("= \"", one_line(at.time()), "\" ", what));
    };
    const TimeOfDay text = time_of_day(at.time());
    if (!text.wrong.empty()) {
      wrong(text.wrong);
      continue;
    }
    const auto time = day_time(text.text);
    if (!time.ok()) {
      wrong(absl::StrCat("is no time of a day, expected \"00:00\" to \"23:59\" with offset: ",
                         time.status().message()));
      continue;
    }
    if (!by_time.empty()) {
      const DayTime &first = by_time.front().first, &before = by_time.back().first;
      if (time->offset_s != first.offset_s)
        wrong("has another offset from UTC than the schedule's first time, expected the same");
      else if (time->local_s == before.local_s)
        wrong("is the time before once more, expected one value for each time");
      else if (time->local_s < before.local_s)
        wrong("is earlier than the time before it, expected times in the order of the day");
    }
    by_time.emplace_back(*time, at);
  }
  if (!findings.empty()) return;
  std::sort(by_time.begin(), by_time.end(),
            [](const auto& a, const auto& b) { return a.first.utc_s < b.first.utc_s; });
  schedule.Clear();
  for (auto& [time, at] : by_time) {
    at.set_time(format_rfc3339_utc(utc_time(time.utc_s)).substr(std::string("1970-01-01T").size()));
    *schedule.Add() = at;
  }
}

const schema::Material* material_of(const schema::Sweep& sweep, const std::string& name) {
  for (const schema::Material& m : sweep.material())
    if (m.name() == name) return &m;
  return nullptr;
}

const schema::BuildUp* build_up_of(const schema::Sweep& sweep, const std::string& name) {
  for (const schema::BuildUp& b : sweep.build_up())
    if (b.name() == name) return &b;
  return nullptr;
}

// Checks that the solar absorptance of a part or of a land material is known.
template <typename Section>
void check_absorptance(const schema::Sweep& sweep, const Section& section,
                       const SectionCheck& check) {
  const schema::Material* material = material_of(sweep, section.material());
  if (material != nullptr && !material->has_solar_absorptance())
    check.error("material",
                absl::StrCat("= \"", one_line(section.material()),
                             "\" has no solar_absorptance, expected the share of sunlight (0.3 to "
                             "2.5 um) that it absorbs, in its [[material]]: temperatures are to "
                             "be computed"));
  if (const schema::BuildUp* build_up = build_up_of(sweep, section.build_up());
      material != nullptr && material->has_solar_absorptance() &&
      material->solar_absorptance() == 0 && build_up != nullptr && build_up->has_canopy())
    check.error("build_up",
                absl::StrCat("= \"", one_line(section.build_up()),
                             "\" has a canopy, which answers to sunlight, and solar_absorptance "
                             "of material \"",
                             one_line(section.material()),
                             "\" is 0, expected more: crops have "
                             "0.8"));
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
    resolve_water(build_up, path, check, findings);
    check_heat_flux(build_up, path, findings);  // before schedules are brought into order
    resolve_schedule(build_up, path, check, findings);
    const auto uses = [&](const auto& of) { return of.build_up() == build_up.name(); };
    if (build_up.has_name() && std::none_of(sweep.part().begin(), sweep.part().end(), uses) &&
        std::none_of(sweep.land().material().begin(), sweep.land().material().end(), uses))
      check.error("name", absl::StrCat("= \"", one_line(build_up.name()), "\" is used by no part",
                                       sweep.has_land() ? " and no [[land.material]]" : "",
                                       ", expected build_up = \"", one_line(build_up.name()),
                                       "\" in one of them"));
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
    if (sweep.has_heat()) check_absorptance(sweep, part, check);
  }
  for (int m = 0; m < sweep.land().material_size(); ++m) {
    const schema::LandMaterial& material = sweep.land().material(m);
    if (!material.has_build_up()) continue;
    const SectionCheck check(material, absl::StrCat("land.material[", m, "]"), findings);
    const schema::BuildUp* build_up = build_up_of(sweep, material.build_up());
    if (build_up == nullptr)
      check.error("build_up",
                  absl::StrCat("= \"", one_line(material.build_up()), "\" is no [[build_up]], ",
                               suggestion(material.build_up(), names)));
    else if (build_up->inside() == "open")
      check.error("build_up", absl::StrCat("= \"", one_line(material.build_up()),
                                           "\", whose inside is open, expected another inside: "
                                           "land has one face"));
    if (sweep.has_heat()) check_absorptance(sweep, material, check);
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
