#pragma once

#include "absl/status/statusor.h"
#include "view/rows/query_row.h"

namespace irsig {

// Returns the extent of the target of a stored sweep, which rows at another range need (ExtentOf).
[[nodiscard]] absl::StatusOr<TargetExtent> stored_target_extent(const StoredSweep& sweep);

}  // namespace irsig
