#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "schema/store/queue.h"

namespace irsig {

// Progress of each sweep, beside the queue: counted from the queue once, then updated with each
// change of a job, so that neither a status nor a lease reads every job. Belongs to the one writer
// of the database, which reports changes after their statements have run.
class ProgressCounters {
 public:
  // Returns the progress of all sweeps, in the order of their ids. Unknown counts are counted
  // (again).
  absl::StatusOr<std::vector<SweepProgress>> all(Database& database);
  // Returns the determinism class of the first sweep that is bound to a class and has open jobs.
  // Empty: no sweep is.
  absl::StatusOr<std::string> bound_class(Database& database);

  // Discards all counts. Call it after a transaction, or a part of a transaction, was undone.
  void forget() { counted_.reset(); }
  // Counts the jobs of a sweep again. Call it whenever the sweep is submitted.
  absl::Status recount(Database& database, const std::string& sweep_sha256);

  void leased(const std::string& sweep_sha256);
  void released(std::int64_t sweep_id);
  // Updates the counts after a change of a job or sweep. quarantined: the value returned by
  // fail_lease.
  void failed(std::int64_t sweep_id, std::uint64_t quarantined);
  void done(const LeasedJob& job, std::uint64_t rays, double worst_relative_error);
  void cancelled(const std::string& sweep_sha256);
  void prioritized(const std::string& sweep_sha256, int priority);
  void bound(const std::string& determinism_class);

 private:
  struct Sweep : CountedSweep {
    bool failures_are_old = true;
  };
  absl::Status count(Database& database);
  Sweep* find(std::int64_t sweep_id);
  Sweep* find(const std::string& sweep_sha256);

  std::optional<std::map<std::int64_t, Sweep>> counted_;
};

}  // namespace irsig
