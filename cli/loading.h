#pragma once

#include <string>

#include "planning/time_budget.h"

namespace irsig {

// load_sweep and spend_time_budget with a line on standard error while they last, where that is
// longer than two seconds.
[[nodiscard]] absl::StatusOr<LoadedSweep> load_shown(const std::string& path,
                                                     const AccuracyAsked& asked);
[[nodiscard]] absl::StatusOr<std::string> spend_shown(LoadedSweep& loaded, std::uint32_t workers);

}  // namespace irsig
