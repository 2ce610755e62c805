#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "schema/job.pb.h"
#include "schema/result.pb.h"
#include "schema/store/tables/rows.h"
#include "schema/sweep.pb.h"

namespace irsig {

class Database;
class ProgressCounters;
struct WritableDatabase;

// Priorities of a sweep are -kMostPriority to kMostPriority.
inline constexpr int kMostPriority = 1000;
// Returns INVALID_ARGUMENT for a priority beyond +-kMostPriority.
[[nodiscard]] absl::Status check_priority(int priority);

// The writing side of a signature database: the coordinator is its only user. Not thread-safe: one
// thread owns it. Every mutation happens inside begin() ... commit(); commit() returns after the
// data is on disk (synchronous = FULL), so that many results can share one commit (group commit).
class StoreWriter {
 public:
  // Creates the file if it does not exist. Refuses a file of another format, a file that is no
  // signature database, and a database that another writer holds.
  static absl::StatusOr<std::unique_ptr<StoreWriter>> open(const std::string& path);
  // Without finish() the journal stays beside the file and belongs to it.
  ~StoreWriter();
  StoreWriter(const StoreWriter&) = delete;
  StoreWriter& operator=(const StoreWriter&) = delete;

  absl::Status begin();
  // Like begin(), but commit() returns before the disk has the transaction: if the machine dies
  // (not the process), the transaction may be lost, and with it all later ones, or none.
  absl::Status begin_unsynced();
  absl::Status commit();
  void rollback();

  // Begins one request among those that share a transaction, which is then either kept or undone,
  // so that a failed statement does not undo the others. FAILED_PRECONDITION from undo_request():
  // the whole transaction is gone (the disk is full).
  absl::Status begin_request();
  absl::Status keep_request();
  absl::Status undo_request();

  // Adds a sweep, its viewpoints, conditions, bands, parts, assets and jobs, or updates the one
  // with the same name: jobs whose key is already done keep their rows; rows of jobs that the sweep
  // no longer has are removed when their replacement is stored (rows whose viewpoint, season, time
  // or band is gone: now). Quarantined and cancelled jobs wait again. INVALID_ARGUMENT: the jobs do
  // not cover viewpoints x conditions x bands exactly once, something comes twice, an asset's bytes
  // are not those of its hash, or the model file is missing; then nothing was changed.
  absl::StatusOr<AddedJobs> add_sweep(const schema::ResolvedSweep& sweep,
                                      const std::string& sweep_sha256,
                                      const std::vector<schema::JobSpec>& jobs,
                                      const std::vector<Asset>& assets);

  // Returns the bytes of an asset, also of one that a job has left; under a sweep_sha256 the
  // serialized ResolvedSweep. DATA_LOSS: an asset's bytes differ from its hash.
  absl::StatusOr<std::string> asset(const std::string& sha256);

  // Replaces an earlier prediction of the same sweep, which need not have been added yet.
  absl::Status store_prediction(const StoredPrediction& prediction);

  // Takes the next waiting job (of the first sweep of the highest priority that has one, in the
  // sweep's order; those that failed before come last) and leases it under a new fencing token;
  // nullopt: none is waiting.
  absl::StatusOr<std::optional<QueuedJob>> lease_next(const std::string& worker_id, double now_s);
  // Lets the job wait again, unless the token is no longer the job's (FAILED_PRECONDITION).
  absl::Status release(std::uint64_t fencing_token, const std::string& reason);
  // Finds a job of a sweep; nullopt if the sweep does not have it (any more). NOT_FOUND: no sweep
  // has this hash.
  absl::StatusOr<std::optional<KnownJob>> find_job(const std::string& sweep_sha256,
                                                   const std::string& job_key);
  // Leases this job to who has its result already; its token. FAILED_PRECONDITION unless the job
  // is waiting or quarantined; of the latter, what was given up because of it alone waits again.
  absl::StatusOr<std::uint64_t> lease_job(const std::string& sweep_sha256,
                                          const std::string& job_key, const std::string& worker_id,
                                          double now_s);
  // Keeps a result that differs from what is stored of its job; of equal ones the first. False:
  // there are kMostAside already.
  static constexpr std::int64_t kMostAside = 1000;
  absl::StatusOr<bool> store_conflicting_result(const std::string& sweep_sha256,
                                                const schema::JobResult& result,
                                                const std::string& content_sha256,
                                                const std::string& worker_name, double now_s);
  absl::StatusOr<std::uint64_t> results_aside();
  // Lets a done job wait again, because another result than the stored one turned out to be right.
  absl::Status reopen(const std::string& sweep_sha256, const std::string& job_key);
  // Reopens every job that this worker has computed, and the jobs that need one of them; returns
  // their number. Their stored results stay until they are replaced.
  absl::StatusOr<std::uint64_t> reopen_all_of(const std::string& worker_name);
  // Returns the tokens of all current leases.
  absl::StatusOr<std::vector<std::uint64_t>> running_tokens();
  // Lets every job under a lease of an earlier coordinator wait again; called once after open.
  absl::Status release_all();
  // Counts a failure on this worker; after failures on 3 distinct workers, or 6 in all, the job is
  // quarantined; for_good: at once.
  absl::Status fail(std::uint64_t fencing_token, const std::string& worker_name,
                    const std::string& message, bool for_good = false);
  // Stores the result and marks the job done, replacing the rows of earlier jobs for the same
  // viewpoint and conditions. FAILED_PRECONDITION: the token is not the current one.
  // INVALID_ARGUMENT: the result does not match its job. content_sha256: of the result, if it is
  // known already.
  absl::Status complete(std::uint64_t fencing_token, const schema::JobResult& result,
                        const std::string& worker_name, const std::string& content_sha256 = {});
  // Lets done heat jobs with a damaged output wait again and returns their number. Reads all
  // outputs.
  absl::StatusOr<std::uint64_t> reopen_damaged();
  // Marks the job done with what a job of the same key has left in another sweep of the database,
  // computed in this determinism class; false: there is none, and the lease goes on. Views are
  // never taken over: their rows are of their own sweep's places.
  absl::StatusOr<bool> take_over(std::uint64_t fencing_token, const std::string& determinism_class);
  absl::StatusOr<std::uint64_t> cancel(const std::string& sweep_sha256);
  // Stores the physics version with which the keys of a sweep were made; 0: not known.
  absl::Status set_physics_version(const std::string& sweep_sha256, std::uint32_t version);
  absl::StatusOr<std::uint32_t> physics_version(const std::string& sweep_sha256);
  // Sets the priority of this sweep's jobs against those of others, from the next lease on; new
  // sweeps have 0. NOT_FOUND: no sweep has this hash. INVALID_ARGUMENT: beyond +-kMostPriority.
  absl::Status set_priority(const std::string& sweep_sha256, int priority);
  absl::StatusOr<std::vector<SweepProgress>> progress();
  // Returns the determinism class to which this database's unfinished sweeps are bound; empty: not
  // bound yet.
  absl::StatusOr<std::string> determinism_class();
  absl::Status bind_determinism_class(const std::string& determinism_class);
  // Checkpoints the journal, so that one plain file remains. UNAVAILABLE: a reader has the file
  // open; everything is stored, the journal stays beside the file, and finish() may be called
  // again.
  absl::Status finish();
  // Removes the file again if this writer made it and nothing was committed to it; true if it did,
  // and then this object is good for nothing but its destructor.
  absl::StatusOr<bool> remove_if_unused();

 private:
  explicit StoreWriter(WritableDatabase opened);
  absl::Status begin(bool synced);
  [[nodiscard]] absl::Status require_transaction() const;

  std::unique_ptr<WritableDatabase> opened_;
  Database& database_;
  bool synced_ = true;
  std::unique_ptr<ProgressCounters> counters_;
};

}  // namespace irsig
