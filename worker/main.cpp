// irsig-worker: computes jobs that a coordinator hands out.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <random>

#include "absl/strings/str_cat.h"
#include "coordinator/client/address.h"
#include "coordinator/client/farm_log.h"
#include "coordinator/client/machine_memory.h"
#include "core/base/keep_memory.h"
#include "core/base/printable.h"
#include "core/base/standard_output.h"
#include "core/image/image.h"
#include "core/scene/trace/tracer.h"
#include "runner/job_runner.h"
#include "worker/lease_loop.h"

namespace {

std::atomic<bool> stop_asked = false;
static_assert(std::atomic<bool>::is_always_lock_free);

// The first signal lets the current job finish, the second one does not.
void ask_to_stop(int) {
  if (stop_asked.exchange(true)) _exit(1);
}

std::string host_name() {
  char host[256] = "localhost";
  gethostname(host, sizeof(host) - 1);
  return host;
}

// Two containers may share host name and process number.
std::string default_name() {
  return absl::StrCat(host_name(), "-", getpid(), "-", absl::Hex(std::random_device()() & 0xffff));
}

// 2: what was given is wrong, or the coordinator refuses this worker for good; 3: it has set it
// aside; 1: anything else.
int report(const absl::Status& status) {
  const std::string what = irsig::printable(std::string(status.message()));
  std::fprintf(stderr, "irsig-worker: %s\n", what.c_str());
  if (absl::IsAborted(status)) return 3;
  return absl::IsInvalidArgument(status) || absl::IsFailedPrecondition(status) ||
                 absl::IsPermissionDenied(status) || absl::IsUnauthenticated(status)
             ? 2
             : 1;
}

absl::StatusOr<std::unique_ptr<irsig::JobRunner>> make_runner(
    const irsig::schema::ResolvedSweep& sweep, const irsig::Assets& assets,
    const irsig::HeatOutputs& heat, irsig::KeptScene& kept) {
  const irsig::ThumbnailEncoder encoder{
      [](std::uint32_t width_px, std::uint32_t height_px, const std::vector<float>& pixels) {
        return irsig::encode_png({width_px, height_px, pixels});
      },
      [](std::uint32_t width_px, std::uint32_t height_px, const std::vector<float>& pixels) {
        return irsig::encode_exr({width_px, height_px, pixels});
      },
      [](std::uint32_t width_px, std::uint32_t height_px, const std::vector<float>& pixels) {
        return irsig::encode_error_exr({width_px, height_px, pixels});
      }};
  return irsig::JobRunner::create(sweep, assets, heat, encoder, &kept);
}

}  // namespace

int main(int argc, char** argv) {
  irsig::keep_freed_memory();
  CLI::App app{"computes the jobs that a coordinator hands out"};
  std::string coordinator;
  irsig::NetworkOptions network;
  irsig::WorkerPlan plan;
  plan.worker_name = default_name();
  plan.host = host_name();
  app.add_option("--coordinator", coordinator, "unix:PATH or HOST:PORT")->required();
  irsig::add_network_options(app, network);
  app.add_option("--name", plan.worker_name, "a name that no other worker has")
      ->capture_default_str();
  app.add_option(
         "--threads", plan.threads,
         "how many jobs it computes at once, with one scene and one set of air between them")
      ->capture_default_str()
      ->check(CLI::Range(1, 4096));
  app.add_flag("--exit-when-finished", plan.exit_when_finished,
               "end when every job of every sweep is settled");
  app.add_option("--give-up-after-s", plan.give_up_after_s,
                 "end when the coordinator has not answered for so long")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e9));
  irsig::LogOptions log;
  irsig::add_log_options(app, log);
  std::string isa;
  app.add_option("--isa", isa,
                 "no wider instruction set than this one, which all machines of a farm have: "
                 "avx512, avx2 or sse4.2");
  app.add_option("--spool", plan.spool_folder,
                 "a folder for results that wait for their coordinator; workers of one machine may "
                 "share it");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (app.exit(error) != 0) return 2;
    const absl::Status printed = irsig::end_standard_output();
    return printed.ok() ? 0 : report(printed);
  }
  auto address = irsig::parse_address(coordinator, network);
  if (!address.ok()) return report(address.status());
  plan.coordinator = *std::move(address);
  if (!isa.empty()) {
    if (auto pinned = irsig::pin_isa(isa); !pinned.ok()) return report(pinned);
  }
  plan.determinism_class = irsig::determinism_class();
  plan.build_id = irsig::build_id();
  plan.memory_bytes = static_cast<std::uint64_t>(irsig::usable_memory_bytes());
  plan.physics_version = static_cast<std::uint32_t>(irsig::physics_version());

  if (auto begun = irsig::start_log("worker", log); !begun.ok()) return report(begun);
  std::signal(SIGTERM, ask_to_stop);
  std::signal(SIGINT, ask_to_stop);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a file at its limit (ulimit -f) is a full disk
  irsig::KeptScene kept;
  const auto status = irsig::run_lease_loop(
      plan,
      [&](const auto& sweep, const auto& assets, const auto& heat) {
        return make_runner(sweep, assets, heat, kept);
      },
      stop_asked);
  return status.ok() ? 0 : report(status);
}
