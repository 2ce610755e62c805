#include "jobs/resolve_sweep.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "jobs/consistency/check_weather.h"
#include "jobs/files/condition_table.h"
#include "jobs/land_build_ups.h"
#include "jobs/resolve.h"
#include "jobs/resolve_heat.h"
#include "jobs/resolve_land.h"
#include "jobs/resolve_plume.h"
#include "jobs/resolve_uncertainty.h"
#include "jobs/text/number_bounds.h"
#include "jobs/text/size_bounds.h"
#include "jobs/text/sweep_file.h"

namespace irsig {
namespace {

// Every default of the sweep file stands here and in docs/reference/keys, except the names
// and hot parts below and those of profiles, images and effects
// (resolve_profiles.cpp, resolve_image.cpp, resolve_effects.cpp). None of them decides what is
// there to be seen: temperatures, materials, surroundings, air and sun have no default.
void write_defaults(schema::Sweep& sweep) {
  if (!sweep.has_description()) sweep.set_description("");
  if (!sweep.has_seed()) sweep.set_seed(1);

  schema::Model& model = *sweep.mutable_model();
  const auto dimension = [](bool has, auto set, double value) {
    if (!has) set(value);
  };
  const auto radius = [&](double m) { model.set_radius_m(m); };
  const auto length = [&](double m) { model.set_length_m(m); };
  const auto width = [&](double m) { model.set_width_m(m); };
  const auto height = [&](double m) { model.set_height_m(m); };
  const std::string& kind = model.generate();
  if (kind == "disk" || kind == "sphere" || kind == "cone")
    dimension(model.has_radius_m(), radius, 1);
  if (kind == "cylinder") dimension(model.has_radius_m(), radius, 0.5);
  if (kind == "cylinder") dimension(model.has_length_m(), length, 3);
  if (kind == "cone" || kind == "box") dimension(model.has_length_m(), length, 2);
  if (kind == "box") dimension(model.has_width_m(), width, 1);
  if (kind == "box") dimension(model.has_height_m(), height, 0.5);
  if (kind == "cooling_tower") dimension(model.has_radius_m(), radius, 4);
  if (kind == "cooling_tower") dimension(model.has_length_m(), length, 12);
  if (kind == "cooling_tower") dimension(model.has_width_m(), width, 12);
  if (kind == "cooling_tower") dimension(model.has_height_m(), height, 10);
  if (kind == "frigate") dimension(model.has_length_m(), length, 153.8);
  if (kind == "frigate") dimension(model.has_width_m(), width, 20.4);
  if (kind == "frigate") dimension(model.has_height_m(), height, 6.4);
  if (model.has_file() && !model.has_reference()) model.set_reference("origin");

  if (has_position(sweep) && !sweep.place().has_height_m()) sweep.mutable_place()->set_height_m(0);

  for (schema::Material& material : *sweep.mutable_material()) {
    if (!material.has_allow_energy_gain()) material.set_allow_energy_gain(false);
    const std::string& surface = material.kind();
    if ((surface == "priest_germer" || surface == "beard_maxwell") && !material.has_published())
      material.set_published(false);
    if (surface == "prisse" && !material.has_printed()) material.set_printed(false);
  }
  for (schema::Part& part : *sweep.mutable_part()) {
    if (part.match_size() == 0 && !part.rest()) part.add_match(part.name());
    if (!part.has_two_sided()) part.set_two_sided(false);
  }

  schema::Viewpoints& viewpoints = *sweep.mutable_viewpoints();
  if (viewpoints.kind() == "fibonacci") {
    if (!viewpoints.has_elevation_min_deg()) viewpoints.set_elevation_min_deg(0);
    if (!viewpoints.has_elevation_max_deg()) viewpoints.set_elevation_max_deg(90);
  }

  write_air_defaults(*sweep.mutable_air());
  write_heat_defaults(sweep);
  write_plume_defaults(sweep);
  write_land_defaults(sweep);

  schema::Transport& transport = *sweep.mutable_transport();
  if (!transport.has_max_reflections()) transport.set_max_reflections(64);
  if (!transport.has_job_size_vertices()) transport.set_job_size_vertices(2e9);

  schema::Accuracy& accuracy = *sweep.mutable_accuracy();
  if (!accuracy.has_relative_error() && !accuracy.has_target_paths() &&
      !accuracy.has_samples_per_replicate() && !accuracy.has_time_budget_s()) {
    accuracy.set_relative_error(0.01);
  }
  // About what cooled cameras resolve.
  if (accuracy.has_relative_error() && !accuracy.has_absolute_error_k())
    accuracy.set_absolute_error_k(0.05);
  if (!accuracy.has_replicates()) accuracy.set_replicates(32);
  if (!accuracy.has_max_samples_per_replicate()) {
    accuracy.set_max_samples_per_replicate(
        std::max<std::uint64_t>(1U << 22U, accuracy.samples_per_replicate()));
  }
}

// "ships/frigate.toml" -> "frigate"
std::string stem(const std::string& file_name) {
  const std::string base = file_name.substr(file_name.find_last_of('/') + 1);
  return base.substr(0, base.find_last_of('.'));
}

// A part that is 30 K or more above the coldest part in any condition gets primary rays of its own:
// at 300 K, 30 K more are 1.57 times the radiance in 8-12 um and 2.71 times in 3-5 um.
void mark_hot_parts(schema::ResolvedSweep& resolved) {
  constexpr double kHotterK = 30;
  // Temperatures that stand in files are known where the mesh is (runner/sweep_temperatures.h).
  for (const schema::Condition& condition : resolved.condition())
    if (condition.has_temperature_field() && !condition.temperature_field().has_heat()) return;
  for (int i = 0; i < resolved.sweep().part_size(); ++i) {
    schema::Part& part = *resolved.mutable_sweep()->mutable_part(i);
    if (part.has_hot()) continue;
    bool hot = false;
    for (const schema::Condition& condition : resolved.condition()) {
      const auto& temperatures_k = condition.part_temperature_k();
      double coldest_k = *std::min_element(temperatures_k.begin(), temperatures_k.end());
      // Temperatures that are computed from the weather lie near the air's.
      if (condition.has_temperature_field()) {
        coldest_k = condition.air_temperature_k();
        for (const double k : temperatures_k)
          if (k > 0) coldest_k = std::min(coldest_k, k);
      }
      hot = hot || temperatures_k[i] >= coldest_k + kHotterK;
    }
    part.set_hot(hot);
  }
}

// Their text is in the conditions, with their names.
void forget_files(schema::Sweep& sweep) {
  sweep.mutable_air()->clear_profile_file();
  for (schema::Season& season : *sweep.mutable_season()) {
    season.clear_profile_file();
    season.clear_modtran_file();
    season.clear_weather_file();
  }
  for (schema::TemperatureField& field : *sweep.mutable_temperature_field()) field.clear_file();
}

void check_sweep_name(const SweepFile& file, schema::Sweep& sweep, Findings& findings) {
  if (!sweep.has_name()) sweep.set_name(stem(file.file_name));
  if (sweep.name().empty() || !is_one_line(sweep.name())) {
    findings.add("name",
                 "name is empty, has control characters or is not UTF-8, expected a plain name");
  } else if (is_formula(sweep.name())) {
    findings.add("name", absl::StrCat("name = \"", sweep.name(), "\": ", kFormulaName));
  }
}

}  // namespace

absl::StatusOr<schema::ResolvedSweep> resolve_sweep(const SweepFile& as_read,
                                                    std::string_view model_bytes,
                                                    std::vector<Problem>* warnings) {
  SweepFile file = as_read;
  RETURN_IF_ERROR(expand_conditions(file));
  schema::ResolvedSweep resolved;
  *resolved.mutable_sweep() = file.sweep;
  Findings findings(file);
  check_sweep_name(file, *resolved.mutable_sweep(), findings);
  check_sizes(file.sweep, "", findings);
  if (!findings.empty()) return findings.status();
  check_numbers(file.sweep, "", findings);
  resolve_target(model_bytes, resolved, findings);
  write_land_build_ups(*resolved.mutable_sweep());
  resolve_build_ups(*resolved.mutable_sweep(), findings);
  check_temperature_fields(file, findings);
  check_run(resolved.sweep(), findings);
  check_effects(file, findings);
  check_heat(resolved.sweep(), findings);
  check_plume(file.sweep, findings);
  check_land(resolved.sweep(), findings);
  check_heights(file.sweep, findings);
  resolve_viewpoints(resolved, findings);
  resolve_conditions(file, resolved, findings);
  check_image(resolved, findings);
  check_profiles(resolved, findings);
  check_row_count(resolved, findings);
  if (!findings.empty()) return findings.status();
  write_defaults(*resolved.mutable_sweep());
  write_effect_defaults(*resolved.mutable_sweep());
  write_image_defaults(*resolved.mutable_sweep());
  write_profile_defaults(*resolved.mutable_sweep());
  mark_hot_parts(resolved);
  check_sweep_imager(resolved.sweep(), findings);
  check_imager_has_images(resolved.sweep(), findings);
  check_weather(resolved, findings);
  resolve_uncertainty(resolved, findings);
  if (!findings.empty()) return findings.status();
  forget_files(*resolved.mutable_sweep());
  resolve_land(file, resolved);
  if (warnings != nullptr)
    for (const schema::Condition& condition : resolved.condition())
      for (const std::string& warning : condition.warning())
        warnings->push_back({"", findings.key_of_odd(warning), warning});
  return resolved;
}

}  // namespace irsig
