#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "schema/store/database.h"

namespace irsig {

// "IRSG": tells a signature database from every other SQLite file (`file` prints it).
inline constexpr std::uint32_t kApplicationId = 0x49525347;

// One step of the file format: `script` takes a database of version - 1 to version.
struct MigrationStep {
  int version;
  const char* script;
};

// The exclusive right to write one database: an flock on "<database>-lock", so that the kernel
// releases it when the holder dies in whatever way. (Not on the database itself: closing a
// descriptor of that file would drop SQLite's own locks on it.) The file is removed when the lock
// is given back.
class WriterLock {
 public:
  static absl::StatusOr<std::unique_ptr<WriterLock>> acquire(const std::string& database_path);
  WriterLock(const WriterLock&) = delete;
  WriterLock& operator=(const WriterLock&) = delete;
  ~WriterLock();

  // The lock file still lies where it was made: nobody else can hold a lock of this name.
  [[nodiscard]] bool holds() const;

 private:
  WriterLock(int descriptor, std::string path) : descriptor_(descriptor), path_(std::move(path)) {}
  int descriptor_;
  std::string path_;
};

struct WritableDatabase {
  std::unique_ptr<WriterLock> lock;  // outlives the connection
  std::unique_ptr<Database> database;
  bool created = false;  // there was no such file
  std::string path;      // where it lies, links followed
};

// Creates or opens for writing, brings to the newest version, switches to write-ahead logging.
// Files that it refuses (schema/store/check_schema.h) stay as they are; a new one is its owner's
// alone (mode 0600); a file that it began to create does not stay behind when
// it fails.
[[nodiscard]] absl::StatusOr<WritableDatabase> open_for_writing(const std::string& path);

// Where a file lies or will be made, links followed; the path as it is where that cannot be told.
[[nodiscard]] std::string real_path(const std::string& path);

// Removes a database and what SQLite keeps beside it. Only for who created it, holds its lock and
// has closed it.
void remove_database(const std::string& path);

// Never creates or changes anything. attaches: database.h.
[[nodiscard]] absl::StatusOr<std::unique_ptr<Database>> open_for_reading(const std::string& path,
                                                                         bool attaches = false);

// Runs the steps above the database's user_version, all in one transaction, which ends as it began
// unless `check` is content with what they have left. INVALID_ARGUMENT: a newer version.
[[nodiscard]] absl::Status migrate(Database& database, std::span<const MigrationStep> steps,
                                   const std::function<absl::Status()>& check = nullptr);

}  // namespace irsig
