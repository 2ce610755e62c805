#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "schema/store/database.h"
#include "schema/store/store.h"

namespace irsig {

// How an attempt ended, as stored (table attempt_outcome; numbers are never reused).
enum class AttemptOutcome : int {
  kRunning = 0,
  kDone = 1,
  kReleased = 2,
  kFailed = 3,
  kRevoked = 4
};

// What a job computes, as stored (table job_kind; numbers are never reused).
enum class JobKind : int { kView = 1, kHeat = 2 };
[[nodiscard]] absl::StatusOr<JobKind> job_kind(std::int64_t stored);

// What a view has besides.
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

// Index lists are stored as JSON arrays: "[0,1,2]".
[[nodiscard]] std::string index_list_text(
    const google::protobuf::RepeatedField<std::uint32_t>& list);
[[nodiscard]] absl::StatusOr<std::vector<std::uint32_t>> index_list(const std::string& text);

[[nodiscard]] absl::StatusOr<std::optional<QueuedJob>> lease_next_job(Database& database,
                                                                      const std::string& worker_id,
                                                                      double now_s);
// FAILED_PRECONDITION: the token is not that of a current lease.
[[nodiscard]] absl::StatusOr<LeasedJob> leased_job(Database& database, std::uint64_t fencing_token);
// Ends the attempt and moves its job to `state`.
[[nodiscard]] absl::Status end_lease(Database& database, std::uint64_t fencing_token,
                                     std::int64_t job_id, AttemptOutcome outcome, JobState state,
                                     const std::string& message, const std::string& worker_name);
// The same for a job that was done: what needs it may be leased now.
[[nodiscard]] absl::Status end_lease_done(Database& database, std::uint64_t fencing_token,
                                          std::int64_t job_id, const std::string& worker_name);
[[nodiscard]] absl::Status fail_lease(Database& database, std::uint64_t fencing_token,
                                      const std::string& worker_name, const std::string& message);
[[nodiscard]] absl::Status release_all_leases(Database& database);
[[nodiscard]] absl::StatusOr<std::uint64_t> cancel_sweep(Database& database,
                                                         const std::string& sweep_sha256);
[[nodiscard]] absl::StatusOr<std::vector<SweepProgress>> sweep_progress(Database& database);
[[nodiscard]] absl::StatusOr<std::string> bound_determinism_class(Database& database);
[[nodiscard]] absl::Status bind_class(Database& database, const std::string& determinism_class);

}  // namespace irsig
