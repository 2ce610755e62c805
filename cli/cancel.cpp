#include <cstdio>

#include "cli/commands.h"
#include "cli/coordinator_options.h"
#include "coordinator/client/farm_client.h"
#include "core/base/status_macros.h"
#include "fmt/format.h"
#include "view/base/print.h"

namespace irsig {
namespace {

absl::Status cancel_sweep(const std::string& sweep, const CoordinatorOptions& coordinator) {
  ASSIGN_OR_RETURN(const auto address, coordinator.address());
  ASSIGN_OR_RETURN(const auto reply, cancel(address, sweep));
  print_text("{} jobs cancelled; submitting the sweep again takes them up again\n",
             reply.cancelled());
  return absl::OkStatus();
}

}  // namespace

void add_cancel(CLI::App& app, int& exit_code) {
  auto* command =
      app.add_subcommand("cancel", "take a sweep's open jobs off a coordinator's queue");
  auto sweep = std::make_shared<std::string>();
  auto coordinator = std::make_shared<CoordinatorOptions>(*command);
  command->add_option("SWEEP", *sweep, "its name, its hash, or 8 digits of it")->required();
  command->callback([=, &exit_code] { exit_code = report(cancel_sweep(*sweep, *coordinator)); });
}

}  // namespace irsig
