#pragma once

#include "absl/status/status.h"
#include "schema/result.pb.h"

namespace irsig {

// Checks a result by itself, whoever sent it: no number beyond the range of the quantity of its
// name, fractions and transmittances between 0 and 1, causes and parts that sum to the intensity
// within the rounding of their sums, pictures that are pictures (check_picture.h), texts of no more
// than a line. INVALID_ARGUMENT, naming the field. check_result compares the result with its job,
// in the transaction that stores it. Thread-safe: touches nothing else.
[[nodiscard]] absl::Status check_plausible(const schema::JobResult& result);

}  // namespace irsig
