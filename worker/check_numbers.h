#pragma once

#include "absl/status/status.h"
#include "core/signature/signature.h"

namespace irsig {

// Whether a view's numbers may be stored. INTERNAL, naming each reason, if the core had to drop
// path weights that were not finite or negative (the rest would be silently too small), if a number
// is not finite, or if an intensity, area or picture is negative by more than its own error. Facets
// met from behind and paths cut off after the last reflection are no reason: the first are counted
// in the result, the second bounded by it.
[[nodiscard]] absl::Status check_numbers(const ViewResult& view);

}  // namespace irsig
