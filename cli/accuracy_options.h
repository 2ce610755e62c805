#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>

#include "planning/load_sweep.h"

namespace irsig {

// Adds --workers, --relative-error, --time-budget-s, --effects and --yes to a command that runs or
// plans a sweep. `accuracy` and `workers` must outlive the command.
void add_accuracy_options(CLI::App& command, AccuracyAsked& accuracy, std::uint32_t& workers);

// Adds --yes alone; large sweeps need it from then on.
void add_size_option(CLI::App& command, AccuracyAsked& accuracy);

// Adds --shard alone.
void add_shard_option(CLI::App& command, AccuracyAsked& accuracy);

// Adds --effects alone.
void add_effects_option(CLI::App& command, AccuracyAsked& accuracy);

}  // namespace irsig
