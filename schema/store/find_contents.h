#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "schema/store/tables/database.h"
#include "schema/store/tables/filters.h"
#include "schema/store/tables/rows.h"

namespace irsig {

// Implements StoreReader::contents and StoreReader::values.
[[nodiscard]] absl::StatusOr<std::vector<SweepContents>> find_contents(Database& database);
[[nodiscard]] absl::StatusOr<std::vector<StoredValue>> find_values(Database& database,
                                                                   const ValueFilter& filter);

}  // namespace irsig
