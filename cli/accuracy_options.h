#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>

#include "planning/load_sweep.h"

namespace irsig {

// --workers, --relative-error, --time-budget-s, --effects and --yes: what commands that run a
// sweep, or plan one, are told besides the sweep file. Both must outlive the command.
void add_accuracy_options(CLI::App& command, AccuracyAsked& accuracy, std::uint32_t& workers);

// --yes alone: from here on large sweeps need it.
void add_size_option(CLI::App& command, AccuracyAsked& accuracy);

// --shard alone.
void add_shard_option(CLI::App& command, AccuracyAsked& accuracy);

// --effects alone.
void add_effects_option(CLI::App& command, AccuracyAsked& accuracy);

}  // namespace irsig
