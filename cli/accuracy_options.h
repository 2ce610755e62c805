#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>

#include "cli/load_sweep.h"

namespace irsig {

// --workers, --relative-error and --time-budget-s: what commands that run a sweep, or plan one, are
// told besides the sweep file. All three must outlive the command.
void add_accuracy_options(CLI::App& command, AccuracyAsked& accuracy, std::uint32_t& workers);

}  // namespace irsig
