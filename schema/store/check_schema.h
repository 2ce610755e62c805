#pragma once

#include <set>
#include <string>

#include "absl/status/status.h"
#include "schema/store/database.h"

namespace irsig {

// Every table, index and view of a file is read and written as the code expects only if it is
// defined as the code defines it: a view may be another query that never ends, a trigger runs with
// whatever is written, a table without its CHECKs holds anything. SQLite's own statistics
// (sqlite_stat1 ...) may be there.

// INVALID_ARGUMENT, with the file's name and that of the first definition that differs, is missing
// or is not ours, unless the definitions are those of the newest format, comments and white space
// apart.
[[nodiscard]] absl::Status check_schema(const std::string& path, Database& database);

// Before an older file is migrated: INVALID_ARGUMENT unless it has no triggers, and no definitions
// by other names than one version or another of the format has had.
[[nodiscard]] absl::Status check_old_schema(const std::string& path, Database& database);

}  // namespace irsig
