#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "coordinator/client/farm_log.h"
#include "coordinator/double_check.h"
#include "coordinator/farm_table.h"
#include "coordinator/lease_book.h"
#include "jobs/keys/sweep_check.h"
#include "schema/farm.pb.h"
#include "schema/store/writer.h"

namespace irsig {

// Time in seconds; a parameter, so that timeouts are ordinary tests.
using Clock = std::function<double()>;

struct FarmRules {
  double heartbeat_s = 2;
  double lost_after_s = 10;
  // Number of losses that are tolerated before further ones count as failures. A job that three
  // workers were lost with, one at a time, is given up; with fewer workers this limit applies,
  // because a job that kills its worker would otherwise be retried for ever.
  std::uint32_t tolerated_losses = 5;
  double audit_fraction = 0.005;  // of jobs that a second worker computes, too
};

// A sweep prepared for storing: everything that can be computed without the store.
struct Submission {
  schema::ResolvedSweep sweep;
  std::string sweep_sha256;
  std::uint32_t physics_version;
  std::vector<schema::JobSpec> jobs;
  std::vector<Asset> assets;
  std::optional<schema::Prediction> prediction = std::nullopt;
  std::optional<int> priority = std::nullopt;  // not stated: as it is
};
// Prepares a sweep for submission. INVALID_ARGUMENT: check_sweep refuses the sweep, a hash is
// wrong, or the physics version is missing.
[[nodiscard]] absl::StatusOr<Submission> make_submission(const SweepCheck& check_sweep,
                                                         schema::ResolvedSweep sweep,
                                                         std::uint32_t physics_version,
                                                         std::vector<Asset> assets);

// A result as a worker returns it. `checked`: outcome of the earlier check of the result by itself
// (check_plausible).
struct Returned {
  std::string worker_id;
  std::uint64_t fencing_token = 0;  // of its lease; 0: it comes from a spool
  std::string sweep_sha256;
  const schema::JobResult& result;
  std::string content_sha256 = {};  // schema/store/tables/content.h; empty: it is worked out
  absl::Status checked = absl::OkStatus();
};

// Decisions of the coordinator: which worker gets which job, and which results are accepted. The
// queue is in the store, so that it survives a restart; only the workers' sessions are here, and
// workers register again. The class uses neither threads nor gRPC. Not thread-safe: the commit
// loop's thread owns it, and opens and commits the store's transactions around its calls.
//
// farm_table.h has the transitions. Errors:
//   NOT_FOUND            the worker is unknown (lost, or of an earlier coordinator); it registers
//                        again
//   FAILED_PRECONDITION  refused for good: a failure whose lease is not current, a worker of
//                        another determinism class or physics version, too many workers, or a
//                        stored sweep that cannot be computed
//   ABORTED              the worker was set aside, with the reason
//   INVALID_ARGUMENT     the result does not belong to its job; it counts as a failure of its lease
class Farm {
 public:
  // Creates a farm.
  //   clock           monotonic, for timeouts
  //   unix_clock      for the record of leases
  //   coordinator_id  differs at every start, so that no worker id is used twice
  //   check_sweep     checks stored sweeps that an earlier coordinator accepted
  Farm(StoreWriter& store, const FarmRules& rules, Clock clock, Clock unix_clock,
       std::string coordinator_id, SweepCheck check_sweep);

  absl::StatusOr<schema::RegisterReply> register_worker(const schema::RegisterRequest& request);
  absl::StatusOr<schema::LeaseReply> lease(const schema::LeaseRequest& request);
  absl::StatusOr<schema::HeartbeatReply> heartbeat(const schema::HeartbeatRequest& request);
  absl::StatusOr<schema::CompleteReply> complete(const Returned& returned);
  absl::Status fail(const schema::FailRequest& request);
  absl::StatusOr<std::shared_ptr<const std::string>> asset(const std::string& sha256);

  absl::StatusOr<schema::SubmitReply> submit(const Submission& submission);
  absl::StatusOr<schema::StatusReply> status();
  absl::StatusOr<schema::CancelReply> cancel(const std::string& sweep_sha256);
  absl::StatusOr<schema::PrioritizeReply> prioritize(const schema::PrioritizeRequest& request);

  // Returns leases that no session knows to the queue. Call it after a request was undone.
  absl::Status release_orphaned_leases();
  // Returns the book of workers that may send a result. Any thread may call this.
  [[nodiscard]] const LeaseBook& leases() const { return leases_; }

  // Returns true if a worker has been silent too long; drop_silent_workers() takes the jobs of such
  // workers.
  [[nodiscard]] bool somebody_is_silent();
  absl::Status drop_silent_workers();

 private:
  struct Session {
    std::string worker_name, host, determinism_class;
    std::uint32_t physics_version;
    std::uint64_t memory_bytes;
    double heard_at_s;
    SessionState state = SessionState::kIdle;
    JobName job = {};  // that it computes
    std::uint64_t fencing_token = 0;
    bool is_duplicate = false;  // another worker has or had the job; not recorded in the queue
    double leased_at_s = 0;
  };
  struct Losses {
    std::uint32_t count = 0;
    std::set<std::string> workers;
  };
  // Rules of a sweep for every lease and every result.
  struct SweepRules {
    std::optional<std::uint32_t> physics_version;  // that its keys were made with, if known
    std::set<std::uint32_t> other_versions = {};   // if not: that they were not made with
    std::vector<std::size_t> wavelengths;          // of the spectra of each band
    std::uint32_t thumbnail_px;
  };
  [[nodiscard]] static LogAbout about(const Session& session) {
    return {.job_key = session.job.job_key, .worker = session.worker_name};
  }
  static SweepRules rules_for(const schema::ResolvedSweep& sweep);
  absl::StatusOr<Session*> hear(const std::string& worker_id);
  absl::Status end_lease(Session& session, const std::string& reason, bool blame_the_job);
  absl::Status count_failure(Session& session, const std::string& message,
                             schema::FailRequest::Kind kind);
  absl::StatusOr<std::optional<QueuedJob>> next_to_compute(const std::string& worker_id,
                                                           const Session& session);
  absl::StatusOr<std::optional<QueuedJob>> next_job_for(const std::string& worker_id,
                                                        const Session& session);
  // Finds a job that is to be computed a second time: for an audit, or because it is late.
  absl::StatusOr<std::optional<QueuedJob>> audit_for(const Session& session);
  absl::StatusOr<std::optional<QueuedJob>> straggling_job_for(const Session& session);
  absl::StatusOr<std::optional<QueuedJob>> duplicate(const JobName& job, JobState expected);
  absl::Status check_class(const Session& session);
  absl::Status check_physics(const Session& session, const JobName& job);
  // Checks that this worker's results may be stored here. The first admitted worker binds the
  // database's determinism class.
  absl::Status admit(const Session& session, const JobName& job);
  SweepRules& remember(const std::string& sweep_sha256, const schema::ResolvedSweep& sweep);
  absl::Status check_against_session(const Session& session, const std::string& sweep_sha256,
                                     const schema::JobResult& result);
  [[nodiscard]] bool should_go_to_another(const Session& session, const std::string& job_key) const;
  [[nodiscard]] static bool has_more_memory(const Session& session, std::uint64_t bytes);
  [[nodiscard]] bool somebody_has_more_memory(std::uint64_t bytes) const;
  absl::StatusOr<bool> all_settled();

  // Stages of accepting a result.
  absl::StatusOr<schema::CompleteReply> take(const Session& session, const JobName& job,
                                             const Returned& returned);
  absl::StatusOr<schema::CompleteReply> store_now(const Session& session, const JobName& job,
                                                  const KnownJob& known, const Returned& returned);
  absl::StatusOr<schema::CompleteReply> compare(const Session& session, const JobName& job,
                                                const KnownJob& known, const Returned& returned);
  absl::Status was_stored(const Session& session, const JobName& job);
  [[nodiscard]] bool somebody_besides(const std::set<std::string>& workers) const;
  absl::Status contradicted(const std::string& worker_name, const std::string& reason);
  absl::Status set_aside(const std::string& worker_name, const std::string& reason);

  StoreWriter& store_;
  FarmRules rules_;
  Clock clock_, unix_clock_;
  std::string coordinator_id_;
  const SweepCheck check_sweep_;
  std::uint64_t registrations_ = 0;
  double checked_at_s_;
  std::map<std::string, Session> sessions_;                 // by worker id
  std::map<std::string, std::set<std::string>> failed_on_;  // job key -> worker names
  std::map<std::string, Losses> losses_;                    // job key -> lost workers
  std::map<std::string, std::uint64_t>
      out_of_memory_;  // job key -> of the worker that had too little
  // Names of workers, with the jobs that failed on them and that another worker has done.
  std::map<std::string, std::set<std::string>> failed_alone_;
  std::map<std::string, std::string> aside_;           // worker name -> why
  std::map<std::string, std::string> of_other_class_;  // refused: worker name -> class
  std::vector<std::string> differing_;                 // messages, for status
  std::deque<std::string> recent_failures_;            // the same
  std::map<std::string, Rate> rates_;                  // by sweep: of done jobs
  DoubleCheck double_check_;
  Stragglers stragglers_;
  std::uint64_t duplicates_ = 0;
  std::map<std::string, std::shared_ptr<const std::string>> assets_;
  std::map<std::string, SweepRules> sweeps_;  // by hash; a cache
  LeaseBook leases_;
  std::optional<bool> all_settled_;  // forgotten whenever the queue changes
};

}  // namespace irsig
