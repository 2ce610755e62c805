#include "schema/store/progress_counters.h"

#include <algorithm>
#include <utility>

#include "core/base/status_macros.h"

namespace irsig {

absl::Status ProgressCounters::count(Database& database) {
  if (counted_) return absl::OkStatus();
  ASSIGN_OR_RETURN(std::vector<CountedSweep> sweeps, count_sweeps(database, std::nullopt));
  counted_.emplace();
  for (CountedSweep& sweep : sweeps) {
    const std::int64_t id = sweep.sweep_id;
    counted_->emplace(id, Sweep{std::move(sweep)});
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<SweepProgress>> ProgressCounters::all(Database& database) {
  IRSIG_STORE_TRY(count(database));
  std::vector<SweepProgress> out;
  for (auto& [id, sweep] : *counted_) {
    SweepProgress& progress = sweep.progress;
    if (progress.quarantined == 0) {
      progress.failures.clear();
    } else if (sweep.failures_are_old) {
      ASSIGN_OR_RETURN(std::vector<std::string> failures,
                       failures_of_sweep(database, id, progress.quarantined));
      progress.failures = std::move(failures);
    }
    sweep.failures_are_old = false;
    out.push_back(progress);
  }
  return out;
}

absl::StatusOr<std::string> ProgressCounters::bound_class(Database& database) {
  IRSIG_STORE_TRY(count(database));
  for (const auto& [id, sweep] : *counted_)
    if (!sweep.determinism_class.empty() && sweep.progress.waiting + sweep.progress.leased > 0)
      return sweep.determinism_class;
  return std::string();
}

absl::Status ProgressCounters::recount(Database& database, const std::string& sweep_sha256) {
  if (!counted_) return absl::OkStatus();
  ASSIGN_OR_RETURN(std::int64_t id, sweep_id_of(database, sweep_sha256));
  ASSIGN_OR_RETURN(std::vector<CountedSweep> sweeps, count_sweeps(database, id));
  counted_->erase(id);
  for (CountedSweep& sweep : sweeps) counted_->emplace(id, Sweep{std::move(sweep)});
  return absl::OkStatus();
}

ProgressCounters::Sweep* ProgressCounters::find(std::int64_t sweep_id) {
  if (!counted_) return nullptr;
  const auto found = counted_->find(sweep_id);
  return found == counted_->end() ? nullptr : &found->second;
}

ProgressCounters::Sweep* ProgressCounters::find(const std::string& sweep_sha256) {
  if (!counted_) return nullptr;
  for (auto& [id, sweep] : *counted_)
    if (sweep.progress.sweep_sha256 == sweep_sha256) return &sweep;
  return nullptr;
}

void ProgressCounters::leased(const std::string& sweep_sha256) {
  if (Sweep* sweep = find(sweep_sha256)) {
    --sweep->progress.waiting;
    ++sweep->progress.leased;
  }
}

void ProgressCounters::released(std::int64_t sweep_id) {
  if (Sweep* sweep = find(sweep_id)) {
    --sweep->progress.leased;
    ++sweep->progress.waiting;
  }
}

void ProgressCounters::failed(std::int64_t sweep_id, std::uint64_t quarantined) {
  Sweep* sweep = find(sweep_id);
  if (sweep == nullptr) return;
  released(sweep_id);
  sweep->progress.waiting -= quarantined;
  sweep->progress.quarantined += quarantined;
  if (quarantined > 0) sweep->failures_are_old = true;
}

void ProgressCounters::done(const LeasedJob& job, std::uint64_t rays, double worst_relative_error) {
  Sweep* sweep = find(job.sweep_id);
  if (sweep == nullptr) return;
  SweepProgress& progress = sweep->progress;
  --progress.leased;
  ++progress.done;
  if (job.kind == JobKind::kHeat) ++progress.heat_done;
  progress.rays += rays;
  progress.worst_relative_error = std::max(progress.worst_relative_error, worst_relative_error);
}

void ProgressCounters::cancelled(const std::string& sweep_sha256) {
  if (Sweep* sweep = find(sweep_sha256)) {
    sweep->progress.cancelled += sweep->progress.waiting + sweep->progress.leased;
    sweep->progress.waiting = sweep->progress.leased = 0;
  }
}

void ProgressCounters::prioritized(const std::string& sweep_sha256, int priority) {
  if (Sweep* sweep = find(sweep_sha256)) sweep->progress.priority = priority;
}

void ProgressCounters::bound(const std::string& determinism_class) {
  if (!counted_) return;
  for (auto& [id, sweep] : *counted_)
    if (sweep.determinism_class.empty() && sweep.progress.waiting + sweep.progress.leased > 0)
      sweep.determinism_class = determinism_class;
}

}  // namespace irsig
