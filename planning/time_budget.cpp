#include "planning/time_budget.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <set>

#include "absl/strings/str_cat.h"
#include "coordinator/client/time_budget.h"
#include "core/base/status_macros.h"
#include "fmt/format.h"
#include "jobs/keys/expand.h"

namespace irsig {
namespace {

constexpr std::uint64_t kFewSamples = 64;
// Samples are added until they take this long: below it, a clock tick of the machine would be
// measured.
constexpr double kEnough_s = 0.2;

struct Timing {
  double seconds = 0;
  double samples = 0;
};

// All conditions and bands of some viewpoints.
absl::StatusOr<Timing> time_views(const LoadedSweep& loaded, std::uint64_t samples,
                                  const std::set<int>& views, KeptScene& kept) {
  auto sweep = with_samples(loaded.resolved, samples);
  // Only workers encode thumbnails; 0.25 ms a row is nothing that a budget would notice.
  sweep.mutable_sweep()->mutable_output()->set_thumbnail_px(0);
  ASSIGN_OR_RETURN(const auto runner,
                   JobRunner::create(sweep, loaded.assets, loaded.heat, {}, &kept));
  Timing timing;
  for (const int view : views) {
    schema::JobSpec job;
    job.set_job_key(sha256_hex(absl::StrCat("pilot ", view)));
    job.mutable_view()->set_viewpoint_index(static_cast<std::uint32_t>(view));
    for (int i = 0; i < sweep.condition_size(); ++i) {
      job.mutable_view()->add_condition_index(static_cast<std::uint32_t>(i));
    }
    for (int i = 0; i < sweep.sweep().band_size(); ++i) {
      job.mutable_view()->add_band_index(static_cast<std::uint32_t>(i));
    }
    const auto start = std::chrono::steady_clock::now();
    ASSIGN_OR_RETURN(const auto result, runner->run(job));
    timing.seconds +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    timing.samples += static_cast<double>(result.samples());
  }
  return timing;
}

}  // namespace

schema::ResolvedSweep with_samples(schema::ResolvedSweep sweep, std::uint64_t samples) {
  auto* accuracy = sweep.mutable_sweep()->mutable_accuracy();
  accuracy->clear_relative_error();
  accuracy->clear_target_paths();
  accuracy->clear_time_budget_s();
  accuracy->clear_absolute_error_k();
  accuracy->set_samples_per_replicate(samples);
  return sweep;
}

bool has_time_budget(const schema::ResolvedSweep& sweep) {
  return sweep.sweep().accuracy().has_time_budget_s();
}

absl::StatusOr<std::string> spend_time_budget(LoadedSweep& loaded, std::uint32_t workers) {
  const auto accuracy = loaded.resolved.sweep().accuracy();
  const int count = loaded.resolved.viewpoint_size();
  const std::set<int> views = {0, count / 2, count - 1};
  RETURN_IF_ERROR(have_temperatures(loaded));
  KeptScene kept;
  // The first run also pays for what is built once (tables, caches): it is not counted.
  if (const auto warm = time_views(loaded, kFewSamples, views, kept); !warm.ok())
    return warm.status();
  ASSIGN_OR_RETURN(const auto few, time_views(loaded, kFewSamples, views, kept));
  Timing many;
  std::uint64_t samples = kFewSamples;
  do {
    samples *= 4;
    ASSIGN_OR_RETURN(many, time_views(loaded, samples, views, kept));
  } while (many.seconds - few.seconds < kEnough_s &&
           samples < accuracy.max_samples_per_replicate());
  const double per_sample_s =
      std::max(1e-12, (many.seconds - few.seconds) / (many.samples - few.samples));
  const double n = static_cast<double>(views.size());
  const double per_job_s = std::max(0.0, (few.seconds - few.samples * per_sample_s) / n);
  ASSIGN_OR_RETURN(const auto answer,
                   samples_per_replicate_for(
                       {.budget_s = accuracy.time_budget_s(),
                        .workers = workers,
                        .jobs = static_cast<std::uint64_t>(count),
                        .seconds_per_job = per_job_s,
                        .seconds_per_sample = per_sample_s,
                        .replicates = accuracy.replicates(),
                        .max_samples_per_replicate = accuracy.max_samples_per_replicate()}));
  loaded.resolved = with_samples(std::move(loaded.resolved), answer);
  return fmt::format("{:g} s for {} viewpoints on {} workers: {} samples per replicate",
                     accuracy.time_budget_s(), count, workers, answer);
}

bool is_same_but_for_samples(const schema::ResolvedSweep& stored,
                             const schema::ResolvedSweep& asked) {
  return canonical_encoding(with_samples(stored, 1)) ==
             canonical_encoding(with_samples(asked, 1)) &&
         stored.sweep().accuracy().has_samples_per_replicate();
}

}  // namespace irsig
