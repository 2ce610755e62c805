#pragma once

#include "absl/status/status.h"
#include "schema/job.pb.h"

namespace irsig {

// Checks a resolved sweep that came from another process as parse_sweep and resolve_sweep check a
// file: the same bounds of numbers (number_bounds.h) and of lists and texts (size_bounds.h), and
// the same rules of each table (resolve.h). Viewpoints, conditions and heat runs must be those that
// resolve_sweep would write. Nothing of the sweep may be used before this check: sizes come first,
// and later checks rely on them. Files that the sweep names by their hashes are not read. The truth
// of the weather is not checked (check_weather.h); it decides only if the workers' rows are
// meaningful.
//
// INVALID_ARGUMENT: one line for each error, the path of the field first ("part[0].temperature_k =
// -5, expected ..."); after 20 errors the rest is counted.
[[nodiscard]] absl::Status check_resolved(const schema::ResolvedSweep& sweep);

}  // namespace irsig
