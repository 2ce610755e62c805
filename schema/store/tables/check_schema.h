#pragma once

#include <string>

#include "absl/status/status.h"
#include "schema/store/tables/database.h"

namespace irsig {

// Every table, index and view of a file is read and written as the code expects only if it is
// defined as the code defines it: a view may be another query that never ends, a trigger runs with
// whatever is written, a table without its CHECKs holds anything. SQLite's own statistics
// (sqlite_stat1 ...) may be there.

// Checks that the definitions in a database are those of the format, apart from comments and white
// space. INVALID_ARGUMENT otherwise: the message names the file and the first definition that
// differs, is missing or is unknown.
[[nodiscard]] absl::Status check_schema(const std::string& path, Database& database);

}  // namespace irsig
