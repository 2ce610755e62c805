#include <algorithm>
#include <cstdio>

#include "cli/commands.h"
#include "coordinator/client/farm_client.h"
#include "fmt/format.h"
#include "view/print.h"

namespace irsig {
namespace {

absl::Status print_status(const std::string& coordinator) {
  const auto address = parse_address(coordinator);
  if (!address.ok()) return address.status();
  const auto status = farm_status(*address);
  if (!status.ok()) return status.status();
  std::size_t width = 5;
  for (const auto& sweep : status->sweep()) width = std::max(width, sweep.name().size());
  print_text("{:<{}} {:>8} {:>8} {:>8} {:>8} {:>9} {:>14} {:>13} {}\n", "sweep", width, "jobs",
             "done", "leased", "failed", "cancelled", "rays", "worst_error_%", "sweep_sha256");
  for (const auto& sweep : status->sweep()) {
    print_text("{:<{}} {:>8} {:>8} {:>8} {:>8} {:>9} {:>14} {:>13.3g} {}\n", sweep.name(), width,
               sweep.jobs(), sweep.done(), sweep.leased(), sweep.quarantined(), sweep.cancelled(),
               sweep.rays(), 100 * sweep.worst_relative_error(), sweep.sweep_sha256());
    for (const auto& failure : sweep.failure()) print_text("  failed: {}\n", failure);
  }
  print_text("{} worker{}\n", status->workers(), status->workers() == 1 ? "" : "s");
  return absl::OkStatus();
}

}  // namespace

void add_status(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("status", "what a running coordinator has done and has to do");
  auto coordinator = std::make_shared<std::string>();
  command->add_option("--coordinator", *coordinator, "unix:PATH or 127.0.0.1:PORT")->required();
  command->callback([=, &exit_code] { exit_code = report(print_status(*coordinator)); });
}

}  // namespace irsig
