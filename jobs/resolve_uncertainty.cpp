#include "jobs/resolve_uncertainty.h"

#include <set>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "jobs/resolve.h"
#include "messages/inputs/moved_sweep.h"
#include "schema/heat_run.h"

namespace irsig {
namespace {

// Returns the properties that a sweep needs for an input to matter.
std::string expected_for(const std::string& input) {
  if (input == "air_temperature_k")
    return "weather at the surface (air_temperature_k, relative_humidity_percent and pressure_pa, "
           "a "
           "weather_file or a day), or homogeneous air";
  if (input == "dew_point_k")
    return "weather at the surface: relative_humidity_percent, a weather_file or a day";
  if (absl::StartsWith(input, "wind_speed_"))
    return "a rough sea, the Navy's aerosol or computed temperatures ([heat]), and a wind";
  if (input == "visibility_relative") return "air.visibility_m or a season's";
  if (absl::StartsWith(input, "cloud_"))
    return "air.model \"atmosphere\" and a cloud: cloud_cover, [[season.cloud]] or a "
           "weather_file's";
  if (input == "solar_absorptance" || input == "conductivity_relative")
    return "computed temperatures ([heat]) of a part";
  if (input == "land_solar_absorptance" || input == "land_conductivity_relative")
    return "computed temperatures ([heat]) of land whose material and build_up no part has";
  if (input == "land_temperature_k")
    return "[land] with a stated temperature: temperature_k of a [[land.material]] or "
           "land_temperature_k";
  if (input == "land_emissivity")
    return "[land] with a material that states its emissivity and that no part has";
  if (input == "convection_relative") return "computed temperatures ([heat])";
  if (input == "sky_emissivity_relative")
    return "computed temperatures ([heat]) under a sky whose long-wave radiation the weather does "
           "not state";
  if (input == "surface_moisture")
    return "computed temperatures ([heat]) of a build_up with surface_moisture or a canopy";
  if (input == "stomatal_resistance_relative")
    return "computed temperatures ([heat]) of a build_up with a canopy";
  if (input == "inside_temperature_k")
    return "computed temperatures ([heat]) of a build_up with inside_temperature_k, or with "
           "temperatures in its inside_schedule";
  if (input == "part_temperature_k")
    return "a part whose temperature is stated or read from a temperature_field";
  if (input == "emissivity") return "a part whose material states one";
  return absl::StrCat("surroundings with ", input);
}

void check_input(const schema::ResolvedSweep& resolved, const UncertainInput& input,
                 Findings& findings) {
  const std::string path = absl::StrCat("uncertainty.", input.name);
  if (findings.any_at(path)) return;
  const MovedSweep moved = moved_sweep(resolved, input, 1);
  if (!moved.without.empty()) {
    findings.add(path,
                 absl::StrCat(path, ": the emissivity of \"",
                              one_line(absl::StrJoin(moved.without, "\", \"")),
                              "\" follows from other properties and cannot be moved by itself, "
                              "expected materials with a stated emissivity (lambert, "
                              "sandford_robertson, prisse, cook_torrance with "
                              "normal_emissivity)"));
  } else if (moved.values == 0) {
    findings.add(path, absl::StrCat(path, " changes nothing in this sweep, expected ",
                                    expected_for(input.name)));
  } else if (moved.share == 0 && moved_sweep(resolved, input, -1).share == 0) {
    findings.add(path, absl::StrCat(path, " = ", input.sigma,
                                    " leaves no value within its range, expected a smaller one"));
  }
}

// The sigmas of the heat model that [uncertainty] does not state, as far as the sweep has what they
// are of. Sources: docs/explanation/methods/thermal.md, "The model's own error".
void add_model_sigmas(schema::ResolvedSweep& resolved) {
  if (!resolved.sweep().heat().model_error()) return;
  const schema::ResolvedSweep nominal = resolved;
  schema::Uncertainty& stated = *resolved.mutable_sweep()->mutable_uncertainty();
  const auto matters = [&](const char* name, double sigma) {
    return moved_sweep(nominal, {name, sigma}, 1).values > 0;
  };
  constexpr double kConvection = 0.3, kSkyEmissivity = 0.04, kMoisture = 0.3, kStomata = 0.3;
  if (!stated.has_convection_relative() && matters("convection_relative", kConvection))
    stated.set_convection_relative(kConvection);
  if (!stated.has_sky_emissivity_relative() && matters("sky_emissivity_relative", kSkyEmissivity))
    stated.set_sky_emissivity_relative(kSkyEmissivity);
  if (!stated.has_surface_moisture() && matters("surface_moisture", kMoisture))
    stated.set_surface_moisture(kMoisture);
  if (!stated.has_stomatal_resistance_relative() &&
      matters("stomatal_resistance_relative", kStomata))
    stated.set_stomatal_resistance_relative(kStomata);
}

}  // namespace

void resolve_uncertainty(schema::ResolvedSweep& resolved, Findings& findings) {
  if (findings.empty()) add_model_sigmas(resolved);
  if (!resolved.sweep().has_uncertainty() || !findings.empty()) return;
  schema::Uncertainty& stated = *resolved.mutable_sweep()->mutable_uncertainty();
  const SectionCheck check(stated, "uncertainty", findings);
  (void)check.one_of("sides", {"one", "both"});
  (void)check.at_most_one({"wind_speed_m_s", "wind_speed_relative"});
  const std::vector<UncertainInput> inputs = uncertain_inputs(stated);
  if (inputs.empty())
    findings.add("uncertainty",
                 "[uncertainty] says no input, expected one sigma of one or more: "
                 "air_temperature_k = 1");
  for (const UncertainInput& input : inputs) check_input(resolved, input, findings);
  if (!findings.empty()) return;
  if (!stated.has_sides()) stated.set_sides("one");
  // The uncertainty of a cloud is one error: an input's where [uncertainty] states it, else the
  // model's.
  for (schema::Condition& c : *resolved.mutable_condition()) {
    if (!c.weather().has_cloud()) continue;
    schema::CloudLayer& layer = *c.mutable_weather()->mutable_cloud();
    layer.set_base_is_input(stated.has_cloud_base_m());
    layer.set_water_path_is_input(stated.has_cloud_water_path_relative());
  }

  const schema::ResolvedSweep nominal = resolved;
  std::vector<schema::HeatRun> runs(nominal.heat().begin(), nominal.heat().end());
  std::set<int> of_land;  // whose changes some input has
  for (const UncertainInput& input : inputs)
    for (const double move : moves_of(nominal, input)) {
      const MovedSweep moved = moved_sweep(nominal, input, move);
      for (int r = 0; r < nominal.heat_size(); ++r) {
        const schema::HeatRun& run = nominal.heat(r);
        const bool land = computes_land(run) && moves_land(nominal, moved.sweep, r);
        if (!land && !(computes_parts(run) && moves_parts(nominal, moved.sweep, r))) continue;
        if (land) of_land.insert(r);
        schema::InputMove& asked = *runs[static_cast<std::size_t>(r)].add_input();
        asked.set_name(input.name);
        asked.set_sigma(input.sigma);
        asked.set_move(move);
      }
    }
  for (std::size_t r = 0; r < runs.size(); ++r) {
    if (runs[r].input_size() == 0) continue;
    runs[r].set_base(static_cast<std::uint32_t>(r));
    if (!of_land.contains(static_cast<int>(r))) runs[r].clear_land_temperature_k();
    *resolved.add_heat() = std::move(runs[r]);
  }
}

}  // namespace irsig
