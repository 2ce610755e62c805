#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "schema/store/tables/database.h"

namespace irsig {

// Implements StoreReader::digest: returns the SHA-256, in hex, of the encoding that
// schema/README.md defines.
[[nodiscard]] absl::StatusOr<std::string> content_digest(Database& database);

}  // namespace irsig
