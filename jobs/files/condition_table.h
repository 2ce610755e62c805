#pragma once

#include "absl/status/status.h"
#include "jobs/text/sweep_file.h"

namespace irsig {

// Writes [weather], [[condition]], condition_file and [vary] out as seasons, with which all else
// works: a season takes what it does not say from [weather]; a condition is a season of one time,
// with what it does not say from the season that it names; each is there once for each set of
// values of [vary]. The keys of the new seasons keep the places at which they were written.
// Nothing is done where a file has none of them. The text of condition_file is in
// file.content["condition_file"].
//
// Errors (INVALID_ARGUMENT, all of them, file:line:column).
[[nodiscard]] absl::Status expand_conditions(SweepFile& file);

}  // namespace irsig
