#pragma once

#include <cstdint>

#include "absl/status/statusor.h"
#include "schema/store/tables/database.h"
#include "schema/store/tables/filters.h"
#include "schema/store/tables/rows.h"

namespace irsig {

// Implements StoreReader::ledger.
[[nodiscard]] absl::StatusOr<StoredLedger> find_ledger(Database& database,
                                                       std::int64_t signature_id);

}  // namespace irsig
