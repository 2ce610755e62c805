#pragma once

#include "absl/status/status.h"
#include "schema/job.pb.h"

namespace irsig {

// Checks a resolved sweep that came from somewhere else as parse_sweep and resolve_sweep check a
// file: the same bounds of numbers (number_bounds.h) and of lists and texts (size_bounds.h), the
// same rules of each table (resolve.h), and that viewpoints, conditions and heat runs are as
// resolve_sweep writes them. Nothing of the sweep may be used before this: sizes come first, and
// later checks may rely on them. Files that the sweep names by their hashes are not read; nor is
// the truth of the weather checked (check_weather.h), which decides only if the workers' rows are
// meaningful.
//
// INVALID_ARGUMENT: one line for each error, the path of the field first ("part[0].temperature_k =
// -5, expected ..."); of more than 20 the rest is counted.
[[nodiscard]] absl::Status check_resolved(const schema::ResolvedSweep& sweep);

}  // namespace irsig
