#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/store/tables/database.h"
#include "schema/store/tables/filters.h"
#include "schema/store/tables/rows.h"

namespace irsig {

// Implements StoreReader::inputs.
[[nodiscard]] absl::StatusOr<std::vector<StoredInput>> find_inputs(Database& database,
                                                                   std::int64_t signature_id);

}  // namespace irsig
