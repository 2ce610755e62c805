#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "coordinator/client/address.h"
#include "runner/job_runner.h"
#include "worker/spool.h"

namespace irsig {

// Callback: makes the runner of jobs: JobRunner::create with an encoder, or a runner of a test.
using RunnerFactory = std::function<absl::StatusOr<std::unique_ptr<JobRunner>>(
    const schema::ResolvedSweep& sweep, const Assets& assets, const HeatOutputs& heat)>;

struct WorkerPlan {
  Address coordinator;
  std::string
      worker_name;  // a worker that registers under a name takes the place of an earlier one
  std::string determinism_class;
  std::string build_id;
  std::uint32_t physics_version = 0;
  std::string host;                // for people
  std::uint64_t memory_bytes = 0;  // that a job may take here; 0: not known
  bool exit_when_finished = false;
  double give_up_after_s = 600;  // without any answer of the coordinator
  std::string spool_folder;      // of results that wait for a coordinator; empty: in memory alone
  Spool::AtStep at_spool_step = {};
  // Number of loops, which compute this many jobs at once with one scene and one set of air. With
  // more than one, each loop is a worker with its own name, worker_name-1 and so on.
  std::uint32_t threads = 1;
};

// Leases jobs, computes them with runners from `make_runner`, and returns the results; a second
// thread sends heartbeats meanwhile. The loop waits for a coordinator that restarts. A result that
// cannot be delivered goes to the spool, and stays there until a coordinator that knows its sweep
// has acknowledged it. This worker delivers it or, when this one has ended, another worker with the
// same spool.
//
// Returns OK when `stop` becomes true (the current job is finished and returned first) or, if
// requested, when every job is settled. FAILED_PRECONDITION: the coordinator refuses this worker
// for good (PERMISSION_DENIED, UNAUTHENTICATED: because of its certificate). ABORTED: the
// coordinator has set this worker aside. UNAVAILABLE: the coordinator has not answered for
// give_up_after_s.
//
// With several threads, the status is that of all threads together. A refusal for good ends all
// threads. A thread that is set aside ends alone; ABORTED means that all were.
[[nodiscard]] absl::Status run_lease_loop(const WorkerPlan& plan, const RunnerFactory& make_runner,
                                          const std::atomic<bool>& stop);

}  // namespace irsig
