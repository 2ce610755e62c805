#pragma once

#include <string>

#include "planning/time_budget.h"

namespace irsig {

// Runs load_sweep or spend_time_budget, and prints a line on standard error while the call lasts
// longer than two seconds.
[[nodiscard]] absl::StatusOr<LoadedSweep> load_shown(const std::string& path,
                                                     const AccuracyAsked& asked);
[[nodiscard]] absl::StatusOr<std::string> spend_shown(LoadedSweep& loaded, std::uint32_t workers);

}  // namespace irsig
