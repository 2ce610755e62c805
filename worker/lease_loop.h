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

// Makes the thing that computes: JobRunner::create with an encoder, or a test's own.
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
  // Loops of their own, which compute as many jobs at once with one scene and one set of air. More
  // than one: each is a worker by the name of its own, worker_name-1 and so on.
  std::uint32_t threads = 1;
};

// Leases jobs, computes them with runners from `make_runner`, returns the results; meanwhile a
// second thread sends heartbeats. A coordinator that restarts is waited for. A result that cannot
// be delivered goes to the spool, and stays there until a coordinator that knows its sweep has
// acknowledged it: to this worker or, when this one has ended, to another one with the same spool.
//
// Returns OK when `stop` becomes true (the current job is finished and returned first) or, if so
// asked, when every job is settled; FAILED_PRECONDITION when the coordinator refuses this worker
// for good (PERMISSION_DENIED, UNAUTHENTICATED: because of its certificate); ABORTED when it has
// set this worker aside; UNAVAILABLE when the coordinator has not answered for give_up_after_s.
//
// With several threads: the same for all of them together. One that is refused for good ends all;
// one that is set aside ends alone, and ABORTED says that all were.
[[nodiscard]] absl::Status run_lease_loop(const WorkerPlan& plan, const RunnerFactory& make_runner,
                                          const std::atomic<bool>& stop);

}  // namespace irsig
