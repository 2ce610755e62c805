#pragma once

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "schema/store/tables/database.h"
#include "schema/store/tables/writer_lock.h"

namespace irsig {

// "IRSG": distinguishes a signature database from other SQLite files (`file` prints it).
inline constexpr std::uint32_t kApplicationId = 0x49525347;

// The version of the format, which schema/sql/create.sql makes.
inline constexpr int kFormat = 29;

struct WritableDatabase {
  std::unique_ptr<WriterLock> lock;  // outlives the connection
  std::unique_ptr<Database> database;
  bool created = false;  // there was no such file
  std::string path;      // where it lies, links followed
};

// Creates or opens a database for writing and switches to write-ahead logging. A new file is
// readable by its owner alone (mode 0600), and is removed again on failure. INVALID_ARGUMENT: the
// file is not a signature database, or has another format; for an older format the message names
// the build that wrote the file. Refused files (schema/store/tables/check_schema.h,
// schema/store/whole_file.h) stay unchanged.
[[nodiscard]] absl::StatusOr<WritableDatabase> open_for_writing(const std::string& path);

// Folds the journal into the database, so that one plain file remains. UNAVAILABLE: a reader has
// the file open; the journal stays beside it.
[[nodiscard]] absl::Status end_write_ahead(WritableDatabase& written);

// Restores the journal if another program has emptied it, before a close without
// end_write_ahead(): the header asks for a journal.
void leave_journal(WritableDatabase& written);

// Removes a database and the files that SQLite keeps beside it. Only the process that created it,
// holds its lock and has closed it may call this.
void remove_database(const std::string& path);

// Opens a database for reading; creates and changes nothing. attaches: see database.h.
[[nodiscard]] absl::StatusOr<std::unique_ptr<Database>> open_for_reading(const std::string& path,
                                                                         bool attaches = false);
// Like open_for_reading(), for a file whose journal is missing (check_has_its_journal); reads the
// file's own content. No program may write to it meanwhile.
[[nodiscard]] absl::StatusOr<std::unique_ptr<Database>> open_as_it_is(const std::string& path);

}  // namespace irsig
