#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "schema/store/tables/database.h"
#include "schema/store/tables/rows.h"

namespace irsig {

// Outcome of an attempt, as stored (table attempt_outcome; numbers are never reused).
enum class AttemptOutcome : int {
  kRunning = 0,
  kDone = 1,
  kReleased = 2,
  kFailed = 3,
  kRevoked = 4
};

// Kind of a job, as stored (table job_kind; numbers are never reused).
enum class JobKind : int { kView = 1, kHeat = 2 };
[[nodiscard]] absl::StatusOr<JobKind> job_kind(std::int64_t stored);

// Properties of a leased view's job.
struct LeasedView {
  std::int64_t viewpoint_id;
  std::vector<std::uint32_t> condition_index;
  std::vector<std::uint32_t> band_index;
};

// A job under a lease.
struct LeasedJob {
  std::int64_t job_id;
  std::int64_t sweep_id;
  std::string job_key;
  JobKind kind;
  LeasedView view;               // of a view
  std::uint32_t heat_index = 0;  // of a heat job: its run in ResolvedSweep.heat
};

// Formats an index list as the stored JSON array "[0,1,2]", and parses it.
[[nodiscard]] std::string index_list_text(
    const google::protobuf::RepeatedField<std::uint32_t>& list);
[[nodiscard]] absl::StatusOr<std::vector<std::uint32_t>> index_list(const std::string& text);

[[nodiscard]] absl::StatusOr<std::optional<QueuedJob>> lease_next_job(Database& database,
                                                                      const std::string& worker_id,
                                                                      double now_s);
// Returns the job under a lease. FAILED_PRECONDITION: the token is not that of a current lease.
[[nodiscard]] absl::StatusOr<LeasedJob> leased_job(Database& database, std::uint64_t fencing_token);
// Ends the attempt and moves its job to `state`.
[[nodiscard]] absl::Status end_lease(Database& database, std::uint64_t fencing_token,
                                     std::int64_t job_id, AttemptOutcome outcome, JobState state,
                                     const std::string& message, const std::string& worker_name);
// Like end_lease(), for a job that was done: jobs that need it may be leased now.
[[nodiscard]] absl::Status end_lease_done(Database& database, std::uint64_t fencing_token,
                                          std::int64_t job_id, const std::string& worker_name);
// Fails a lease, and returns the number of jobs that are quarantined for it: none, this one, or
// also the jobs that need it.
[[nodiscard]] absl::StatusOr<std::uint64_t> fail_lease(Database& database,
                                                       std::uint64_t fencing_token,
                                                       const LeasedJob& job,
                                                       const std::string& worker_name,
                                                       const std::string& message, bool for_good);
// Implement the functions of StoreWriter.
[[nodiscard]] absl::StatusOr<std::optional<KnownJob>> known_job(Database& database,
                                                                const std::string& sweep_sha256,
                                                                const std::string& job_key);
[[nodiscard]] absl::StatusOr<std::uint64_t> lease_this_job(Database& database,
                                                           const std::string& sweep_sha256,
                                                           const std::string& job_key,
                                                           const std::string& worker_id,
                                                           double now_s);
[[nodiscard]] absl::StatusOr<std::vector<std::uint64_t>> running_lease_tokens(Database& database);
[[nodiscard]] absl::Status release_all_leases(Database& database);
[[nodiscard]] absl::StatusOr<std::int64_t> sweep_id_of(Database& database,
                                                       const std::string& sweep_sha256);
// Returns the ids of the sweep's parts, in order.
[[nodiscard]] absl::StatusOr<std::vector<std::int64_t>> part_ids(Database& database,
                                                                 std::int64_t sweep_id);
[[nodiscard]] absl::StatusOr<std::uint64_t> cancel_sweep(Database& database,
                                                         const std::string& sweep_sha256);

// A sweep's jobs, counted; without the messages of those that failed.
struct CountedSweep {
  std::int64_t sweep_id;
  std::string determinism_class;  // empty: not bound
  SweepProgress progress;
};
// Counts one sweep, or all, in the order of their ids. Reads every job: 5 s for 10^6.
[[nodiscard]] absl::StatusOr<std::vector<CountedSweep>> count_sweeps(
    Database& database, std::optional<std::int64_t> only);

// Why jobs were quarantined: at most 20 lines, then "and N more". `quarantined`: how many are.
inline constexpr std::size_t kMostFailures = 20;
[[nodiscard]] absl::StatusOr<std::vector<std::string>> failures_of_sweep(Database& database,
                                                                         std::int64_t sweep_id,
                                                                         std::uint64_t quarantined);

[[nodiscard]] absl::StatusOr<std::vector<SweepProgress>> sweep_progress(Database& database);

}  // namespace irsig
