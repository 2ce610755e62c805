#pragma once

#include "absl/status/status.h"
#include "schema/result.pb.h"

namespace irsig {

// Checks a result by itself, whoever sent it. Numbers lie in the range of the quantity that their
// name states; fractions and transmittances are between 0 and 1. Causes and parts sum to the
// intensity within the rounding of their sums. Pictures are valid (check_picture.h), and texts have
// at most one line. INVALID_ARGUMENT otherwise; the message names the field. check_result compares
// the result with its job, in the transaction that stores it. Thread-safe: uses no other data.
[[nodiscard]] absl::Status check_plausible(const schema::JobResult& result);

}  // namespace irsig
