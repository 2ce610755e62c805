#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "schema/store/database.h"
#include "schema/store/store.h"

namespace irsig {

// StoreReader::find.
[[nodiscard]] absl::StatusOr<std::vector<StoredSignature>> find_signatures(
    Database& database, const SignatureFilter& filter);

}  // namespace irsig
