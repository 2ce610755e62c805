#include "schema/store/tables/writer_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "absl/strings/str_cat.h"
#include "schema/store/tables/database.h"

namespace irsig {
namespace {

absl::Status no_lock_file(const std::string& path) {
  return absl::InvalidArgumentError(
      absl::StrCat(path,
                   ": is no regular file, but irsig locks the database by a file of this "
                   "name: remove it"));
}

// Empty: there is no such file.
std::string whole_text(const std::string& database) {
  struct stat there {};
  if (::stat(database.c_str(), &there) != 0) return "";
  return absl::StrCat("whole ", there.st_dev, " ", there.st_ino, "\n");
}

std::string text_of(int descriptor) {
  char text[100];
  const ssize_t size = ::pread(descriptor, text, sizeof text, 0);
  return size > 0 ? std::string(text, static_cast<std::size_t>(size)) : "";
}

}  // namespace

std::string lock_path(const std::string& database) { return database + "-lock"; }

absl::StatusOr<std::unique_ptr<WriterLock>> WriterLock::acquire(const std::string& database,
                                                                const std::string& name) {
  const std::string path = lock_path(database);
  // The file may be removed by its last holder between open and flock; then the lock is on a file
  // without a name, and the next round opens the new one.
  for (;;) {
    // Through no link: what it names might be somebody else's. O_NONBLOCK: a FIFO does not wait.
    const int descriptor =
        ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0600);
    if (descriptor < 0) {
      const int code = errno;
      if (code == ELOOP || code == ENXIO || code == EISDIR) return no_lock_file(path);
      return unusable_file(name, "written", code);
    }
    std::unique_ptr<WriterLock> lock(new WriterLock(descriptor, path, database));
    struct stat opened {};
    if (::fstat(descriptor, &opened) != 0 || !S_ISREG(opened.st_mode)) {
      lock->path_.clear();
      return no_lock_file(path);
    }
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
      lock->path_.clear();  // the holder's to remove
      return absl::FailedPreconditionError(
          absl::StrCat(name, ": another irsig is writing this database (one writer at a time)"));
    }
    if (lock->holds()) {
      const std::string whole = whole_text(database);
      lock->said_ = !whole.empty() && text_of(descriptor) == whole;
      if (!lock->said_) static_cast<void>(::ftruncate(descriptor, 0));  // of another file
      return lock;
    }
    lock->path_.clear();
  }
}

bool WriterLock::holds() const {
  struct stat ours {};
  struct stat named {};
  return ::fstat(descriptor_, &ours) == 0 && ::lstat(path_.c_str(), &named) == 0 &&
         ours.st_ino == named.st_ino && ours.st_dev == named.st_dev;
}

void WriterLock::say_whole_without_journal() {
  const std::string text = whole_text(database_);
  if (text.empty() || ::ftruncate(descriptor_, 0) != 0) return;
  said_ = ::pwrite(descriptor_, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
}

void WriterLock::say_nothing() {
  if (said_ && ::ftruncate(descriptor_, 0) == 0) said_ = false;
}

WriterLock::~WriterLock() {
  if (!path_.empty() && !said_ && holds()) ::unlink(path_.c_str());
  ::close(descriptor_);
}

LockFile read_lock_file(const std::string& database) {
  LockFile out;
  const int descriptor =
      ::open(lock_path(database).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor < 0) return out;
  const std::string whole = whole_text(database);
  out.whole_without_journal = !whole.empty() && text_of(descriptor) == whole;
  // Given back at once, by the close.
  out.held = ::flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(descriptor);
  return out;
}

}  // namespace irsig
