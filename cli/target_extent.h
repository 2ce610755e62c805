#pragma once

#include "absl/status/statusor.h"
#include "view/rows/query_row.h"

namespace irsig {

// How far the target of a stored sweep reaches: what rows at another range ask for (ExtentOf).
[[nodiscard]] absl::StatusOr<TargetExtent> stored_target_extent(const StoredSweep& sweep);

}  // namespace irsig
