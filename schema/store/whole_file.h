#pragma once

#include <string>

#include "absl/status/status.h"

namespace irsig {

// A database has its journal beside it, under its name: a name is taken for the file. These are
// the cases in which it is not. `name` is what the user calls the database, `path` its real path
// (real_path).

// Returns the path at which a file lies or will be made, links followed; the path itself where that
// cannot be told.
[[nodiscard]] std::string real_path(const std::string& path);

// Returns true if a journal with at least one commit lies beside the database. An empty journal
// does not count: a program that only reads leaves one beside an incomplete copy.
[[nodiscard]] bool has_journal(const std::string& path);

// Returns true if the lock of a writer lies beside the database, links followed. The lock of a
// killed writer stays there until the next writer ends.
[[nodiscard]] bool has_writer_lock(const std::string& path);

// Refuses a file whose journal is missing. INVALID_ARGUMENT: the header asks for a journal, and
// neither a journal nor a writer is there. Such a file does not show what is missing: it is an
// incomplete copy, or a hard link whose journal lies beside another name, or whole (another SQLite
// program folded the journal in after a kill).
//   holds_lock  the caller is the writer
[[nodiscard]] absl::Status check_has_its_journal(const std::string& name, const std::string& path,
                                                 bool holds_lock = false);

// Refuses a file with several names (hard links), since each name would have a journal and a lock
// of its own: INVALID_ARGUMENT.
[[nodiscard]] absl::Status check_has_one_name(const std::string& name, const std::string& path);

}  // namespace irsig
