#include "cli/commands.h"
#include "cli/coordinator_options.h"
#include "coordinator/client/farm_client.h"
#include "core/base/status_macros.h"
#include "view/base/print.h"

namespace irsig {
namespace {

absl::Status prioritize_sweep(const std::string& sweep, int priority,
                              const CoordinatorOptions& coordinator) {
  ASSIGN_OR_RETURN(const auto address, coordinator.address());
  RETURN_IF_ERROR(prioritize(address, sweep, priority));
  print_text("{} has priority {} now: each worker that asks for a job gets one of the highest\n",
             sweep, priority);
  return absl::OkStatus();
}

}  // namespace

void add_prioritize(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand(
      "prioritize", "say which of a coordinator's sweeps workers go on with first");
  auto sweep = std::make_shared<std::string>();
  auto priority = std::make_shared<int>(0);
  auto coordinator = std::make_shared<CoordinatorOptions>(*command);
  command->add_option("SWEEP", *sweep, "its name, its hash, or 8 digits of it")->required();
  command->add_option("PRIORITY", *priority, "-1000 to 1000; sweeps have 0 unless told otherwise")
      ->required();
  command->callback(
      [=, &exit_code] { exit_code = report(prioritize_sweep(*sweep, *priority, *coordinator)); });
}

}  // namespace irsig
