#pragma once

#include "absl/status/status.h"
#include "jobs/text/sweep_file.h"

namespace irsig {

// Writes [weather], [[condition]], condition_file and [vary] out as seasons, which all other code
// uses. A season takes missing values from [weather]. A condition is a season of one time, and
// takes missing values from the season that it names. Each of them occurs once for each set of
// values of [vary]. The keys of the new seasons keep the places at which they were written. A file
// without these tables stays unchanged. The text of condition_file is in
// file.content["condition_file"].
//
// Errors (INVALID_ARGUMENT, all of them, file:line:column).
[[nodiscard]] absl::Status expand_conditions(SweepFile& file);

}  // namespace irsig
