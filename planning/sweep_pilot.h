#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/accuracy/cost_model.h"
#include "planning/load_sweep.h"
#include "planning/pilot_farm.h"
#include "view/report/effect_ledger.h"

namespace irsig {

// Measurements of a sweep's pilot. Times are CPU times of jobs that a real worker computed and a
// real coordinator stored, apart from start_s.
struct SweepPilot {
  std::vector<ViewPilot> view;
  CountRule rule;
  double target_paths_per_sample = 0;
  std::uint64_t views = 0;          // of the sweep
  std::uint64_t jobs_per_view = 1;  // of the sweep
  double cpu_s = 0;                 // of the whole pilot
  double start_s = 0;               // wall time of a worker until its first job: program and scene
  double database_fixed_bytes = 0, database_bytes_per_view = 0;
  std::vector<LedgerRow> ledger;  // of the piloted views' rows, by the largest count of samples
};

// Runs a few viewpoints of the sweep with few samples on a farm of one worker, with a database that
// is deleted afterwards. There are 5 viewpoints spread over the set, and up to 15 while their
// predicted times scatter by more than a tenth of the mean. Of more than 18 conditions it computes
// 12, the extremes of light and temperature first, and 3 or 36 once more, from which the time of
// the others follows. Changes of computed temperatures by uncertain inputs are not computed.
// FAILED_PRECONDITION: the sweep has a time budget that no pilot has converted to samples yet.
[[nodiscard]] absl::StatusOr<SweepPilot> pilot_sweep(const LoadedSweep& loaded);
// Like pilot_sweep(loaded), on another farm.
[[nodiscard]] absl::StatusOr<SweepPilot> pilot_sweep(const LoadedSweep& loaded, PilotFarm& farm);

// Returns the costs of the piloted views.
[[nodiscard]] std::vector<ViewCost> view_costs(const SweepPilot& pilot, const CountRule& rule);

}  // namespace irsig
