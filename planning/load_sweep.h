#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "jobs/text/sweep_file.h"
#include "planning/sweep_size.h"
#include "runner/job_runner.h"

namespace irsig {

// Settings of the command line in place of the sweep file's: at most one of [accuracy]; [effects]
// as "auto", "all" or "only=direct_sun,path_sun"; and the shard.
struct AccuracyAsked {
  std::optional<double> relative_error, time_budget_s;
  std::optional<std::string> effects = std::nullopt;
  std::string shard = {};  // "2/3": jobs/shard.h; empty: all of it
  bool any_size = true;    // false: more than sweep_size.h's limits is INVALID_ARGUMENT
};

// A sweep that can be computed: its file is valid, and its scene could be built.
struct LoadedSweep {
  SweepFile file;
  schema::ResolvedSweep resolved;
  Assets assets;
  HeatOutputs heat = {};  // outputs of its heat jobs; empty: not computed yet
  // Warnings, one line each: its weather (jobs/consistency/check_weather.h), open shells of its
  // model.
  std::vector<std::string> warnings;
  JobMemory memory = {};  // of one worker
  SweepSize size = {};
};

// Reads a sweep file and the files that it names, without resolving the sweep.
[[nodiscard]] absl::StatusOr<SweepFile> load_sweep_file(const std::string& path);
// Like load_sweep_file(), for a text that is not written yet, as if it were the file `path`.
[[nodiscard]] absl::StatusOr<SweepFile> load_sweep_text(const std::string& text,
                                                        const std::string& path);

// Reads, resolves and tries a sweep. INVALID_ARGUMENT or NOT_FOUND: lists every error as
// file:line:column: ..., including errors of the model and of the scene.
[[nodiscard]] absl::StatusOr<LoadedSweep> load_sweep(const std::string& path,
                                                     const AccuracyAsked& asked);
[[nodiscard]] absl::StatusOr<LoadedSweep> try_sweep(SweepFile file, const std::string& path,
                                                    const AccuracyAsked& asked);

// Computes the temperatures of the sweep's heat jobs in this process, unless they are known
// already.
[[nodiscard]] absl::Status have_temperatures(LoadedSweep& loaded);

}  // namespace irsig
