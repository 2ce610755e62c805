#include "cli/accuracy_options.h"

namespace irsig {

void add_accuracy_options(CLI::App& command, AccuracyAsked& accuracy, std::uint32_t& workers) {
  command.add_option("--workers", workers, "worker processes (default: one for each core)")
      ->check(CLI::Range(1, 4096));
  auto* error = command.add_option(
      "--relative-error", accuracy.relative_error,
      "wanted of every in-band intensity, instead of the sweep file's [accuracy]");
  command
      .add_option("--time-budget-s", accuracy.time_budget_s,
                  "wall time to spend, instead of the sweep file's [accuracy]")
      ->excludes(error);
  add_effects_option(command, accuracy);
  add_size_option(command, accuracy);
}

void add_size_option(CLI::App& command, AccuracyAsked& accuracy) {
  accuracy.any_size = false;
  command.add_flag("--yes", accuracy.any_size,
                   "go on though the sweep is larger than irsig takes unasked");
}

void add_shard_option(CLI::App& command, AccuracyAsked& accuracy) {
  command
      .add_option("--shard", accuracy.shard,
                  "only the K-th of N parts of the viewpoints, into a database of its own: `irsig "
                  "merge` unites them")
      ->type_name("K/N");
}

void add_effects_option(CLI::App& command, AccuracyAsked& accuracy) {
  command
      .add_option("--effects", accuracy.effects,
                  "auto, all, or only=NAME,NAME (`irsig show effects` lists them), instead of the "
                  "sweep file's [effects]")
      ->type_name("WHICH");
}

}  // namespace irsig
