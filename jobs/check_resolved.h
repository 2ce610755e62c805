#pragma once

#include "absl/status/status.h"
#include "schema/job.pb.h"

namespace irsig {

// What parse_sweep and resolve_sweep see to in a file, of a resolved sweep that came from somewhere
// else: the same bounds of numbers (number_bounds.h) and of lists and texts (size_bounds.h), the
// same rules of each table (resolve.h), and that viewpoints, conditions and heat runs are as
// resolve_sweep writes them. Nothing of the sweep may be used before this: sizes come first, and
// what follows may count on them. Files that the sweep names by their hashes are not looked at; nor
// is whether the weather can be true (check_weather.h), which decides no more than whether the
// workers' rows mean something.
//
// INVALID_ARGUMENT: one line for each error, the path of the field first ("part[0].temperature_k =
// -5, expected ..."); of more than 20 the rest is counted.
[[nodiscard]] absl::Status check_resolved(const schema::ResolvedSweep& sweep);

}  // namespace irsig
