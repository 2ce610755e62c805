#pragma once

#include <string>

#include "absl/status/status.h"
#include "schema/store/tables/database.h"

namespace irsig {

// The code can rely on a table, index or view of a file only if it is defined as the code defines
// it. Otherwise a view may be another query that never ends, a trigger may run at each write, and a
// table without its CHECKs may hold anything. SQLite's own statistics (sqlite_stat1 ...) are
// allowed.

// Checks that the definitions in a database are those of the format, apart from comments and white
// space. INVALID_ARGUMENT otherwise: the message names the file and the first definition that
// differs, is missing or is unknown.
[[nodiscard]] absl::Status check_schema(const std::string& path, Database& database);

}  // namespace irsig
