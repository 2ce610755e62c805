#pragma once

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "schema/store/tables/database.h"
#include "schema/store/tables/writer_lock.h"

namespace irsig {

// "IRSG": tells a signature database from every other SQLite file (`file` prints it).
inline constexpr std::uint32_t kApplicationId = 0x49525347;

// The version of the format, which schema/sql/create.sql makes.
inline constexpr int kFormat = 27;

struct WritableDatabase {
  std::unique_ptr<WriterLock> lock;  // outlives the connection
  std::unique_ptr<Database> database;
  bool created = false;  // there was no such file
  std::string path;      // where it lies, links followed
};

// Creates or opens for writing, switches to write-ahead logging. INVALID_ARGUMENT: the file is no
// signature database, or one of another format; an older one is named with the build that wrote it.
// Files that it refuses (schema/store/tables/check_schema.h, schema/store/whole_file.h) stay as
// they are; a new one is its owner's alone (mode 0600); a file that it began to create does not
// stay behind when it fails.
[[nodiscard]] absl::StatusOr<WritableDatabase> open_for_writing(const std::string& path);

// Folds the journal in, so that one plain file remains. UNAVAILABLE: a reader has the file open;
// the journal stays beside it.
[[nodiscard]] absl::Status end_write_ahead(WritableDatabase& written);

// Restores the journal if another program has emptied it, before a close without
// end_write_ahead(): the header asks for a journal.
void leave_journal(WritableDatabase& written);

// Removes a database and what SQLite keeps beside it. Only for who created it, holds its lock and
// has closed it.
void remove_database(const std::string& path);

// Opens a database for reading; creates and changes nothing. attaches: see database.h.
[[nodiscard]] absl::StatusOr<std::unique_ptr<Database>> open_for_reading(const std::string& path,
                                                                         bool attaches = false);
// Like open_for_reading(), for a file whose journal is missing (check_has_its_journal): its own
// content. No program may write to it meanwhile.
[[nodiscard]] absl::StatusOr<std::unique_ptr<Database>> open_as_it_is(const std::string& path);

}  // namespace irsig
