#include <cstdio>
#include <optional>

#include "cli/accuracy_options.h"
#include "cli/commands.h"
#include "cli/coordinator_options.h"
#include "cli/loading.h"
#include "coordinator/client/farm_client.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "fmt/format.h"
#include "planning/load_sweep.h"
#include "planning/time_budget.h"
#include "view/base/print.h"

namespace irsig {
namespace {

absl::Status submit_sweep(const std::string& sweep_path, const CoordinatorOptions& coordinator,
                          const AccuracyAsked& asked, std::optional<int> priority) {
  ASSIGN_OR_RETURN(const auto address, coordinator.address());
  // Nobody there is said before minutes are spent on a large model.
  if (const auto there = farm_status(address); !there.ok()) return there.status();
  ASSIGN_OR_RETURN(auto loaded, load_shown(sweep_path, asked));
  for (const std::string& line : loaded.warnings) print_note("{}\n", line);
  if (has_time_budget(loaded.resolved)) {
    return placed_problem(
        loaded.file.location("accuracy.time_budget_s"),
        "a time budget is for `irsig run`, which knows how many workers of which speed there are; "
        "give relative_error or samples_per_replicate instead");
  }
  ASSIGN_OR_RETURN(const auto reply,
                   submit(address, loaded.resolved, loaded.assets,
                          static_cast<std::uint32_t>(physics_version()), nullptr, priority));
  print_text("{}: {} jobs, {} to compute\nsweep {}\n", loaded.resolved.sweep().name(), reply.jobs(),
             reply.jobs_to_compute(), reply.sweep_sha256());
  return absl::OkStatus();
}

}  // namespace

void add_submit(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("submit", "hand a sweep to a running coordinator");
  auto sweep = std::make_shared<std::string>();
  auto coordinator = std::make_shared<CoordinatorOptions>(*command);
  command->add_option("SWEEP", *sweep, "the sweep file")->required();
  auto asked = std::make_shared<AccuracyAsked>();
  add_effects_option(*command, *asked);
  add_size_option(*command, *asked);
  add_shard_option(*command, *asked);
  auto priority = std::make_shared<std::optional<int>>();
  command->add_option("--priority", *priority,
                      "-1000 to 1000: workers are given jobs of the sweeps with the highest first; "
                      "as it was, 0 for a new sweep");
  command->callback([=, &exit_code] {
    exit_code = report(submit_sweep(*sweep, *coordinator, *asked, *priority));
  });
}

}  // namespace irsig
