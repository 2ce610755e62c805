#pragma once

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace irsig {

// The exclusive right to write one database: an flock on "<database>-lock", which the kernel
// releases however the holder ends. (The lock is not on the database itself, because closing a
// descriptor of that file would drop SQLite's own locks on it.) The file is removed when the lock
// is released.
//
// The lock file also marks the two moments in which a database's header asks for a journal that
// does not exist. They lie between the header's change to write-ahead mode and the first commit,
// and between the removal of the journal and the header's change back. The database is complete
// then; if the writer is killed, the lock file stays and states that.
class WriterLock {
 public:
  // Takes the lock. database: its real path. name: the user's name for the database, used in
  // messages.
  static absl::StatusOr<std::unique_ptr<WriterLock>> acquire(const std::string& database,
                                                             const std::string& name);
  WriterLock(const WriterLock&) = delete;
  WriterLock& operator=(const WriterLock&) = delete;
  ~WriterLock();

  // Returns true if the lock file still exists at its path, so that no other process can hold a
  // lock of this name.
  [[nodiscard]] bool holds() const;

  // States in the lock file that the database, as its present file (device and inode), is complete
  // without a journal. The lock file then stays when the lock is released. A failure to write it is
  // no error: after a kill the user is asked instead (schema/store/whole_file.h).
  void say_whole_without_journal();
  // Withdraws that statement: a commit has reached the journal, or the header no longer asks for a
  // journal.
  void say_nothing();

 private:
  WriterLock(int descriptor, std::string path, std::string database)
      : descriptor_(descriptor), path_(std::move(path)), database_(std::move(database)) {}
  int descriptor_;
  std::string path_;  // empty: not ours to remove
  std::string database_;
  bool said_ = false;
};

// State of the lock file beside a database, for processes that do not hold the lock.
struct LockFile {
  bool held = false;                   // by a living writer
  bool whole_without_journal = false;  // stated by say_whole_without_journal(), of this file
};
[[nodiscard]] LockFile read_lock_file(const std::string& database);

// Returns the path of the lock file.
[[nodiscard]] std::string lock_path(const std::string& database);

}  // namespace irsig
