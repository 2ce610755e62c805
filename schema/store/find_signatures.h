#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/store/tables/database.h"
#include "schema/store/tables/filters.h"
#include "schema/store/tables/rows.h"

namespace irsig {

// Implements StoreReader::find_ids.
[[nodiscard]] absl::StatusOr<std::vector<std::int64_t>> find_signature_ids(
    Database& database, const SignatureFilter& filter);

// Implements StoreReader::read.
[[nodiscard]] absl::StatusOr<std::vector<StoredSignature>> read_signatures(
    Database& database, std::span<const std::int64_t> ids);

}  // namespace irsig
