#pragma once

#include "absl/status/status.h"
#include "schema/result.pb.h"

namespace irsig {

// What can be told of a result by itself, whoever sent it: no number beyond what the quantity of
// its name can have, shares and transmittances between 0 and 1, causes and parts that sum to the
// intensity within the rounding of their sums, pictures that are pictures (check_picture.h), texts
// of no more than a line. INVALID_ARGUMENT, naming the field. What depends on the job is held
// against it by check_result, in the transaction that stores it. Thread-safe: touches nothing else.
[[nodiscard]] absl::Status check_plausible(const schema::JobResult& result);

}  // namespace irsig
