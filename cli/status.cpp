#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/strings/str_join.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "cli/commands.h"
#include "cli/coordinator_options.h"
#include "cli/output_options.h"
#include "coordinator/client/certificate.h"
#include "coordinator/client/farm_client.h"
#include "fmt/ostream.h"
#include "view/print.h"
#include "view/table.h"

namespace irsig {
namespace {

// One line a sweep.
absl::Status write_rows(const schema::StatusReply& status, std::string_view format,
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
                                   {"heat_done"}},
                                  out);
  if (!writer.ok()) return writer.status();
  for (const auto& sweep : status.sweep())
    (*writer)->row({sweep.name(), sweep.jobs(), sweep.done(), sweep.leased(), sweep.quarantined(),
                    sweep.cancelled(), sweep.rays(), sweep.worst_relative_error(),
                    sweep.sweep_sha256(), absl::StrJoin(sweep.failure(), "\n"),
                    std::uint64_t{status.workers()}, sweep.heat_jobs(), sweep.heat_done()});
  return (*writer)->finish();
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
  for (const auto& warning : status.warning()) fmt::print(out, "warning: {}\n", warning);
  return absl::OkStatus();
}

std::string_view state_name(schema::WorkerStatus::State state) {
  switch (state) {
    case schema::WorkerStatus::STATE_IDLE:
      return "idle";
    case schema::WorkerStatus::STATE_COMPUTING:
      return "computing";
    case schema::WorkerStatus::STATE_SET_ASIDE:
      return "set aside";
    default:
      return "";
  }
}

// One line a worker.
absl::Status write_workers(const schema::StatusReply& status, std::string_view format,
                           std::ostream& out) {
  auto writer = make_table_writer(format,
                                  {{"worker"},
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
    (*writer)->row({worker.name(), std::string(state_name(worker.state())),
                    computes ? Cell(worker.job_s()) : Cell(),
                    worker.memory_bytes() > 0 ? Cell(std::uint64_t{worker.memory_bytes()}) : Cell(),
                    worker.reason(), worker.job_key(), worker.determinism_class()});
  }
  return (*writer)->finish();
}

absl::Status show_status(const CoordinatorOptions& coordinator, const OutputOptions& output,
                         bool workers) {
  const auto address = coordinator.address();
  if (!address.ok()) return address.status();
  auto status = farm_status(*address);
  if (!status.ok()) return status.status();
  if (address->tls)
    for (const std::string& end :
         running_out(*address->tls, absl::ToDoubleSeconds(absl::Now() - absl::UnixEpoch())))
      status->add_warning("on this side " + end);
  return output.write([&](std::string_view format, std::ostream& out) {
    if (format != "text" || workers)
      for (const std::string& warning : status->warning()) print_note("warning: {}\n", warning);
    if (workers) return write_workers(*status, format, out);
    return format == "text" ? write_text(*status, out) : write_rows(*status, format, out);
  });
}

}  // namespace

void add_status(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("status", "what a running coordinator has done and has to do");
  auto coordinator = std::make_shared<CoordinatorOptions>(*command);
  auto output =
      std::make_shared<OutputOptions>(*command, std::vector<std::string>{"text", "csv", "json"});
  auto workers = std::make_shared<bool>(false);
  command->add_flag("--workers", *workers, "a line for each worker instead of each sweep");
  command->callback(
      [=, &exit_code] { exit_code = report(show_status(*coordinator, *output, *workers)); });
}

}  // namespace irsig
