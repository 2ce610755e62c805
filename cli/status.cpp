#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "absl/strings/str_join.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "cli/commands.h"
#include "cli/coordinator_options.h"
#include "cli/output_options.h"
#include "coordinator/client/certificate.h"
#include "coordinator/client/farm_client.h"
#include "coordinator/client/progress_text.h"
#include "core/base/status_macros.h"
#include "fmt/ostream.h"
#include "planning/interruption.h"
#include "view/base/print.h"
#include "view/base/progress.h"
#include "view/base/table.h"

namespace irsig {
namespace {

// One line a sweep.
absl::Status write_status_rows(const schema::StatusReply& status, std::string_view format,
                               std::ostream& out) {
  auto writer = make_table_writer(format,
                                  {{"sweep"},
                                   {"jobs"},
                                   {"done"},
                                   {"leased"},
                                   {"failed"},
                                   {"cancelled"},
                                   {"rays"},
                                   {"worst_relative_error"},
                                   {"sweep_sha256"},
                                   {"failures"},
                                   {"workers"},
                                   {"heat_jobs"},
                                   {"heat_done"},
                                   {"priority"},
                                   {"done_per_s"}},
                                  out);
  if (!writer.ok()) return writer.status();
  for (const auto& sweep : status.sweep())
    (*writer)->row({sweep.name(), sweep.jobs(), sweep.done(), sweep.leased(), sweep.quarantined(),
                    sweep.cancelled(), sweep.rays(), sweep.worst_relative_error(),
                    sweep.sweep_sha256(), absl::StrJoin(sweep.failure(), "\n"),
                    std::uint64_t{status.workers()}, sweep.heat_jobs(), sweep.heat_done(),
                    double(sweep.priority()),
                    sweep.done_per_s() > 0 ? Cell(sweep.done_per_s()) : Cell()});
  return (*writer)->finish();
}

// Whose jobs are under way longest: three at most, from ten seconds on.
std::vector<const schema::WorkerStatus*> slowest(const schema::StatusReply& status) {
  constexpr double kLong_s = 10;
  constexpr std::size_t kMost = 3;
  std::vector<const schema::WorkerStatus*> out;
  for (const auto& worker : status.worker())
    if (worker.state() == schema::WorkerStatus::STATE_COMPUTING && worker.job_s() >= kLong_s)
      out.push_back(&worker);
  std::stable_sort(out.begin(), out.end(),
                   [](const auto* a, const auto* b) { return a->job_s() > b->job_s(); });
  out.resize(std::min(out.size(), kMost));
  return out;
}

absl::Status write_text(const schema::StatusReply& status, std::ostream& out) {
  std::size_t width = 5;
  for (const auto& sweep : status.sweep()) width = std::max(width, sweep.name().size());
  fmt::print(out, "{:<{}} {:>8} {:>8} {:>8} {:>8} {:>9} {:>14} {:>13} {}\n", "sweep", width, "jobs",
             "done", "leased", "failed", "cancelled", "rays", "worst_error_%", "sweep_sha256");
  for (const auto& sweep : status.sweep()) {
    fmt::print(out, "{:<{}} {:>8} {:>8} {:>8} {:>8} {:>9} {:>14} {:>13.3g} {}\n", sweep.name(),
               width, sweep.jobs(), sweep.done(), sweep.leased(), sweep.quarantined(),
               sweep.cancelled(), sweep.rays(), 100 * sweep.worst_relative_error(),
               sweep.sweep_sha256());
    if (const std::uint64_t left = sweep.jobs() - settled_jobs(sweep);
        left > 0 && sweep.done_per_s() > 0)
      fmt::print(out, "  {:.3g} jobs/s, {} left\n", sweep.done_per_s(),
                 duration_text(static_cast<double>(left) / sweep.done_per_s()));
    if (sweep.priority() != 0) fmt::print(out, "  priority: {}\n", sweep.priority());
    if (sweep.heat_jobs() > 0)
      fmt::print(out, "  temperatures: {} of {} jobs done\n", sweep.heat_done(), sweep.heat_jobs());
    for (const auto& failure : sweep.failure()) fmt::print(out, "  failed: {}\n", failure);
  }
  std::size_t computing = 0;
  for (const auto& worker : status.worker())
    computing += worker.state() == schema::WorkerStatus::STATE_COMPUTING ? 1 : 0;
  fmt::print(out, "{} worker{}, {} computing", status.workers(), status.workers() == 1 ? "" : "s",
             computing);
  if (status.audited() > 0)
    fmt::print(out, "; {} job{} computed by two workers", status.audited(),
               status.audited() == 1 ? "" : "s");
  if (status.differing() > 0) fmt::print(out, ", {} with other results", status.differing());
  fmt::print(out, "\n");
  for (const auto& worker : status.worker()) {
    if (worker.state() == schema::WorkerStatus::STATE_SET_ASIDE)
      fmt::print(out, "  set aside: {}: {}\n", worker.name(), worker.reason());
  }
  for (const schema::WorkerStatus* slow : slowest(status))
    fmt::print(out, "  longest: job {} on {}{}{}, for {}\n", slow->job_key().substr(0, 12),
               slow->name(), slow->host().empty() ? "" : " at ", slow->host(),
               duration_text(slow->job_s()));
  for (const auto& failure : status.recent_failure())
    fmt::print(out, "  failed, tried again: {}\n", failure);
  for (const auto& warning : status.warning()) fmt::print(out, "warning: {}\n", warning);
  return absl::OkStatus();
}

// One line a worker.
absl::Status write_workers(const schema::StatusReply& status, std::string_view format,
                           std::ostream& out) {
  auto writer = make_table_writer(format,
                                  {{"worker"},
                                   {"host"},
                                   {"state"},
                                   {"job_s"},
                                   {"memory_bytes"},
                                   {"reason"},
                                   {"job_key", false},
                                   {"determinism_class", false}},
                                  out);
  if (!writer.ok()) return writer.status();
  for (const auto& worker : status.worker()) {
    const bool computes = worker.state() == schema::WorkerStatus::STATE_COMPUTING;
    (*writer)->row({worker.name(), worker.host(), std::string(state_name(worker.state())),
                    computes ? Cell(worker.job_s()) : Cell(),
                    worker.memory_bytes() > 0 ? Cell(std::uint64_t{worker.memory_bytes()}) : Cell(),
                    worker.reason(), worker.job_key(), worker.determinism_class()});
  }
  return (*writer)->finish();
}

// Until every job is settled, or the user has seen enough.
absl::Status follow(const Address& coordinator) {
  using namespace std::chrono_literals;
  constexpr double kPatienceS = 60;  // a coordinator may be started again
  hear_interruptions();
  ProgressLine line;
  std::map<std::string, SweepWatch> watch;
  const auto start = std::chrono::steady_clock::now();
  std::optional<double> answered_s;
  while (!interrupted()) {
    const auto status = farm_status(coordinator, 5);
    const double now_s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (status.ok()) {
      answered_s = now_s;
      std::string text;
      std::size_t open = 0;
      for (const auto& sweep : status->sweep()) {
        if (settled_jobs(sweep) == sweep.jobs()) continue;
        const std::string of_sweep =
            watch[sweep.sweep_sha256()].text(sweep, status->workers(), now_s);
        if (++open == 1) text = fmt::format("{}: {}", sweep.name(), of_sweep);
      }
      if (open == 0) return absl::OkStatus();
      if (open > 1)
        text += fmt::format("; {} more sweep{}", open - 1, open == 2 ? " waits" : "s wait");
      line.show(text);
    } else if (!absl::IsUnavailable(status.status()) || !answered_s ||
               now_s - *answered_s > kPatienceS) {
      return status.status();
    } else {
      line.show(fmt::format("no answer for {:.0f} s", now_s - *answered_s));
    }
    for (int i = 0; i < 10 && !interrupted(); ++i) std::this_thread::sleep_for(100ms);
  }
  return absl::OkStatus();
}

absl::Status show_status(const CoordinatorOptions& coordinator, const OutputOptions& output,
                         bool workers, bool followed) {
  ASSIGN_OR_RETURN(const auto address, coordinator.address());
  if (followed) {
    RETURN_IF_ERROR(follow(address));
  }
  ASSIGN_OR_RETURN(auto status, farm_status(address));
  if (address.tls)
    for (const std::string& end :
         running_out(*address.tls, absl::ToDoubleSeconds(absl::Now() - absl::UnixEpoch())))
      status.add_warning("on this side " + end);
  return output.write([&](std::string_view format, std::ostream& out) {
    if (format != "text" || workers)
      for (const std::string& warning : status.warning()) print_note("warning: {}\n", warning);
    if (workers) return write_workers(status, format, out);
    return format == "text" ? write_text(status, out) : write_status_rows(status, format, out);
  });
}

}  // namespace

void add_status(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("status", "what a running coordinator has done and has to do");
  auto coordinator = std::make_shared<CoordinatorOptions>(*command);
  auto output =
      std::make_shared<OutputOptions>(*command, std::vector<std::string>{"text", "csv", "json"});
  auto workers = std::make_shared<bool>(false);
  command->add_flag("--by-worker", *workers, "a line for each worker instead of each sweep");
  auto followed = std::make_shared<bool>(false);
  command->add_flag(
      "--follow", *followed,
      "first show how far it is, once a second, until every job is settled or Ctrl-C");
  command->callback([=, &exit_code] {
    exit_code = report(show_status(*coordinator, *output, *workers, *followed));
  });
}

}  // namespace irsig
