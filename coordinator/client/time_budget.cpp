#include "coordinator/client/time_budget.h"

#include <bit>
#include <cmath>

#include "absl/status/status.h"
#include "fmt/format.h"

namespace irsig {
namespace {
constexpr std::uint64_t kFewestSamples = 16;
}

absl::StatusOr<std::uint64_t> samples_per_replicate_for(const BudgetQuestion& question) {
  if (!(question.budget_s > 0) || question.workers == 0 || question.replicates == 0 ||
      !(question.seconds_per_sample > 0) || !(question.seconds_per_job >= 0)) {
    return absl::InvalidArgumentError(fmt::format(
        "a time budget of {} s with {} workers, {} replicates, {} s a sample and {} s a "
        "job has no meaning",
        question.budget_s, question.workers, question.replicates, question.seconds_per_sample,
        question.seconds_per_job));
  }
  const std::uint64_t waves =
      std::max<std::uint64_t>(1, (question.jobs + question.workers - 1) / question.workers);
  const double seconds_for_samples =
      question.budget_s / static_cast<double>(waves) - question.seconds_per_job;
  const double samples = seconds_for_samples / (question.seconds_per_sample * question.replicates);
  if (samples < static_cast<double>(kFewestSamples)) {
    const double needed_s =
        static_cast<double>(waves) *
        (question.seconds_per_job +
         question.seconds_per_sample * question.replicates * static_cast<double>(kFewestSamples));
    return absl::InvalidArgumentError(fmt::format(
        "a time budget of {:g} s is too short: {} jobs on {} workers take at least {:.3g} s",
        question.budget_s, question.jobs, question.workers, needed_s));
  }
  const double capped = std::min(samples, static_cast<double>(question.max_samples_per_replicate));
  return std::bit_floor(static_cast<std::uint64_t>(capped));
}

}  // namespace irsig
