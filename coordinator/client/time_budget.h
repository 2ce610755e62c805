#pragma once

#include <cstdint>

#include "absl/status/statusor.h"

namespace irsig {

// A pilot's measurements, and the remaining work.
struct BudgetQuestion {
  double budget_s;            // wall time of the whole sweep
  std::uint32_t workers;      // that compute at the same time
  std::uint64_t jobs;         // still to compute
  double seconds_per_job;     // of a job, apart from its samples
  double seconds_per_sample;  // of one sample, all conditions and bands included
  std::uint32_t replicates;   // of each job
  std::uint64_t max_samples_per_replicate;
};

// Returns the samples per replicate that fill the time budget: a power of two (the sampler's
// sequences are balanced there), rounded down so that the budget is kept. Time is counted in whole
// waves, ceil(jobs / workers), because the last wave leaves some workers idle. INVALID_ARGUMENT:
// not even 16 samples fit; the message states the budget that would be needed.
[[nodiscard]] absl::StatusOr<std::uint64_t> samples_per_replicate_for(
    const BudgetQuestion& question);

}  // namespace irsig
