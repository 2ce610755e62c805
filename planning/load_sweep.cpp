#include "planning/load_sweep.h"

#include <algorithm>
#include <filesystem>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/printable.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/base/user_file.h"
#include "core/scene/import/model_file.h"
#include "jobs/files/material_files.h"
#include "jobs/files/temperature_files.h"
#include "jobs/files/weather_files.h"
#include "jobs/keys/expand.h"
#include "jobs/resolve_land.h"
#include "jobs/resolve_plume.h"
#include "jobs/resolve_sweep.h"
#include "jobs/shard.h"
#include "runner/heat_outputs.h"
#include "runner/sweep_temperatures.h"

namespace irsig {
namespace {

// Each once.
std::vector<std::string> located_warnings(const std::vector<Problem>& warnings,
                                          const SweepFile& file) {
  std::vector<std::string> lines;
  for (const Problem& warning : warnings) {
    std::string line =
        absl::StrCat(file.location(warning.key), ": warning: ", file.as_written(warning.text));
    if (std::find(lines.begin(), lines.end(), line) == lines.end())
      lines.push_back(std::move(line));
  }
  return lines;
}

// Errors about what the command line said name its option as their place.
absl::Status replace_effects(const std::string& asked, SweepFile& file) {
  constexpr const char* kOption = "--effects";
  std::erase_if(file.where, [](const auto& entry) { return entry.first.rfind("effects", 0) == 0; });
  schema::Effects& effects = *file.sweep.mutable_effects();
  effects.Clear();
  file.where["effects"] = file.where["effects.mode"] = kOption;
  const std::size_t equals = asked.find('=');
  effects.set_mode(asked.substr(0, equals));
  if (equals == std::string::npos) return absl::OkStatus();
  if (effects.mode() != "only")
    return absl::InvalidArgumentError(
        absl::StrCat(kOption, " ", asked, ": expected auto, all or only=NAME,NAME"));
  file.where["effects.only"] = kOption;
  for (const auto name : absl::StrSplit(asked.substr(equals + 1), ',', absl::SkipEmpty())) {
    file.where[absl::StrCat("effects.only[", effects.only_size(), "]")] = kOption;
    effects.add_only(std::string(name));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<SweepFile> load_sweep_file(const std::string& path) {
  const std::string ending =
      absl::AsciiStrToLower(std::filesystem::path(path).extension().string());
  for (const char* of_model : {".obj", ".ply", ".stl", ".gltf", ".glb"})
    if (ending == of_model)
      return absl::InvalidArgumentError(
          absl::StrCat(path, ": this is a model, expected a sweep file: `irsig init --model ", path,
                       "` writes one"));
  const auto text = read_user_file(path, kMostSpecBytes);
  if (!text.ok()) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": ", text.status().message()));
  }
  if (absl::StartsWith(*text, "SQLite format 3"))
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": this is a database, expected a sweep file"));
  return load_sweep_text(*text, path);
}

absl::StatusOr<SweepFile> load_sweep_text(const std::string& text, const std::string& path) {
  ASSIGN_OR_RETURN(auto file, parse_sweep(text, path));
  const auto reader = [&](std::uint64_t most_bytes) {
    return [&path, most_bytes](const std::string& name) {
      return read_file_beside(path, name, most_bytes);
    };
  };
  for (const auto read : {read_material_files, read_weather_files})
    RETURN_IF_ERROR(read(file, reader(kMostTableBytes)));
  RETURN_IF_ERROR(read_temperature_files(file, reader(kMostModelBytes)));
  RETURN_IF_ERROR(read_plume_file(file, reader(kMostModelBytes)));
  RETURN_IF_ERROR(read_land_files(file, [&](const std::string& name) {
    return read_model_beside(path, name, kMostModelBytes);
  }));
  return file;
}

absl::StatusOr<LoadedSweep> load_sweep(const std::string& path, const AccuracyAsked& asked) {
  ASSIGN_OR_RETURN(auto file, load_sweep_file(path));
  return try_sweep(std::move(file), path, asked);
}

absl::StatusOr<LoadedSweep> try_sweep(SweepFile file, const std::string& path,
                                      const AccuracyAsked& asked) {
  LoadedSweep loaded;
  loaded.file = std::move(file);
  auto* accuracy = loaded.file.sweep.mutable_accuracy();
  if (asked.relative_error || asked.time_budget_s) {
    accuracy->clear_relative_error();
    accuracy->clear_target_paths();
    accuracy->clear_samples_per_replicate();
    accuracy->clear_time_budget_s();
    if (asked.time_budget_s) accuracy->clear_absolute_error_k();
    if (asked.relative_error) accuracy->set_relative_error(*asked.relative_error);
    if (asked.time_budget_s) accuracy->set_time_budget_s(*asked.time_budget_s);
    loaded.file.where["accuracy.relative_error"] = "--relative-error";
    loaded.file.where["accuracy.time_budget_s"] = "--time-budget-s";
  }
  if (asked.effects) {
    RETURN_IF_ERROR(replace_effects(*asked.effects, loaded.file));
  }
  std::string model_bytes;
  if (loaded.file.sweep.model().has_file()) {
    const std::string& model = loaded.file.sweep.model().file();
    auto bytes = read_model_beside(path, model, kMostModelBytes);
    if (!bytes.ok()) {
      return placed_problem(
          loaded.file.location("model.file"),
          absl::StrCat("model.file \"", one_line(model), "\": ", bytes.status().message()));
    }
    model_bytes = *std::move(bytes);
  }
  std::vector<Problem> warnings;
  ASSIGN_OR_RETURN(auto resolved, resolve_sweep(loaded.file, model_bytes, &warnings));
  loaded.resolved = std::move(resolved);
  if (!loaded.resolved.model_sha256().empty())
    loaded.assets[loaded.resolved.model_sha256()] = std::move(model_bytes);
  for (const auto& [name, bytes] : fields_of(loaded.file))
    loaded.assets[sha256_hex(bytes)] = std::string(bytes);
  if (const std::string_view bytes = plume_bytes(loaded.file); !bytes.empty())
    loaded.assets[sha256_hex(bytes)] = std::string(bytes);
  for (const auto& [key, bytes] : land_bytes(loaded.file))
    loaded.assets[sha256_hex(bytes)] = std::string(bytes);
  loaded.warnings = located_warnings(warnings, loaded.file);
  // Stored with the conditions as they were written.
  for (schema::Condition& condition : *loaded.resolved.mutable_condition())
    for (std::string& warning : *condition.mutable_warning())
      warning = loaded.file.as_written(warning);
  if (!asked.shard.empty()) RETURN_IF_ERROR(take_shard(asked.shard, loaded.resolved));
  loaded.size = size_of(loaded.resolved, bytes_of(loaded.assets));
  if (!asked.any_size) RETURN_IF_ERROR(check_size(loaded.size));
  const auto runner = JobRunner::create(loaded.resolved, loaded.assets, {});
  if (!runner.ok()) return located(loaded.file, runner.status());
  loaded.memory = (*runner)->memory();
  // How many facets have temperatures is known only now.
  loaded.size.database_bytes += static_cast<double>((*runner)->heat_bytes());
  if (!asked.any_size) RETURN_IF_ERROR(check_size(loaded.size));
  for (std::string& line : located_warnings((*runner)->warnings(), loaded.file))
    loaded.warnings.push_back(std::move(line));
  return loaded;
}

absl::Status have_temperatures(LoadedSweep& loaded) {
  if (!awaits_temperatures(loaded.resolved, loaded.heat)) return absl::OkStatus();
  auto computed = heat_outputs(loaded.resolved, loaded.assets);
  if (!computed.ok()) return located(loaded.file, computed.status());
  loaded.heat = *std::move(computed);
  return absl::OkStatus();
}

}  // namespace irsig
