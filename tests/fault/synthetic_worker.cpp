// A worker that does no physics, for tests that kill it: irsig-worker with another runner.
#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <vector>

#include "coordinator/client/address.h"
#include "tests/fault/synthetic_farm.h"
#include "worker/lease_loop.h"

namespace {
std::atomic<bool> stop_asked = false;
}

int main(int argc, char** argv) {
  CLI::App app;
  std::string coordinator;
  irsig::WorkerPlan plan;
  irsig::SyntheticWork work;
  plan.determinism_class = irsig::kSyntheticClass;
  plan.physics_version = 1;
  app.add_option("--coordinator", coordinator)->required();
  app.add_option("--name", plan.worker_name)->required();
  app.add_option("--threads", plan.threads);
  app.add_option("--class", plan.determinism_class);
  app.add_flag("--exit-when-finished", plan.exit_when_finished);
  app.add_option("--seconds", work.seconds);
  app.add_option("--failing", work.failing);
  app.add_option("--crashing", work.crashing);
  app.add_option("--failing-heat", work.failing_heat);
  app.add_option("--wrong", work.wrong);
  app.add_option("--memory-bytes", plan.memory_bytes);
  app.add_option("--needed-bytes", work.needed_bytes);
  app.add_option("--spool", plan.spool_folder);
  int die_at = -1;
  app.add_option("--die-at-spool-step", die_at);
  CLI11_PARSE(app, argc, argv);
  std::signal(SIGTERM, [](int) { stop_asked = true; });
  auto address = irsig::parse_address(coordinator);
  if (!address.ok()) return 2;
  plan.coordinator = *std::move(address);
  work.memory_bytes = plan.memory_bytes;
  plan.at_spool_step = [die_at](irsig::Spool::Step step) {
    if (static_cast<int>(step) == die_at) std::raise(SIGKILL);
  };
  const auto status = irsig::run_lease_loop(plan, irsig::synthetic_runner(work), stop_asked);
  if (status.ok()) return 0;
  std::fprintf(stderr, "%s\n", std::string(status.message()).c_str());
  return absl::IsAborted(status) ? 3 : absl::IsFailedPrecondition(status) ? 2 : 1;
}
