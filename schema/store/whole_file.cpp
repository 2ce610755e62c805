#include "schema/store/whole_file.h"

#include <sys/stat.h>

#include <filesystem>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "schema/store/tables/database.h"
#include "schema/store/tables/writer_lock.h"

namespace irsig {
namespace {

namespace fs = std::filesystem;

constexpr off_t kJournalHeaderBytes = 32;  // https://www.sqlite.org/fileformat.html, section 4.1

std::uint64_t names_of(const std::string& path) {
  struct stat there {};
  return ::stat(path.c_str(), &there) == 0 ? there.st_nlink : 0;
}

bool exists(const std::string& path) {
  struct stat there {};
  return ::lstat(path.c_str(), &there) == 0;
}

// A writer that begins or ends changes header, journal and lock file one after the other, never so
// that all three are missing at once. Whoever looks at them one after the other may still find
// them so; not three times.
constexpr int kLooks = 3;

}  // namespace

std::string real_path(const std::string& path) {
  std::error_code error, absent;
  fs::path real = fs::weakly_canonical(path, error);
  // A link to what does not exist yet: where SQLite will make it.
  for (int links = 0; !error && links < 40 && fs::is_symlink(fs::symlink_status(real, absent));
       ++links) {
    const fs::path target = fs::read_symlink(real, error);
    if (!error) real = fs::weakly_canonical(real.parent_path() / target, error);
  }
  return error || real.empty() ? path : real.string();
}

bool has_journal(const std::string& path) {
  struct stat there {};
  return ::stat((path + "-wal").c_str(), &there) == 0 && there.st_size > kJournalHeaderBytes;
}

bool has_writer_lock(const std::string& path) { return exists(lock_path(real_path(path))); }

absl::Status check_has_its_journal(const std::string& name, const std::string& path,
                                   bool holds_lock) {
  for (int look = 0; look < kLooks; ++look) {
    ASSIGN_OR_RETURN(const FileHeader header, read_file_header(path));
    // A rollback journal: the header itself is being changed, or was when its writer was killed.
    if (!header.write_ahead_log || has_journal(path) || exists(path + "-journal"))
      return absl::OkStatus();
    const LockFile lock = read_lock_file(path);
    if ((lock.held && !holds_lock) || lock.whole_without_journal) return absl::OkStatus();
  }
  const std::uint64_t names = names_of(path);
  const std::string several =
      names > 1 ? absl::StrCat(" (it has ", names, " hard links: `find / -xdev -samefile ", path,
                               "` lists them; open it by the one with a -wal beside it)")
                : std::string();
  return absl::InvalidArgumentError(absl::StrCat(
      name, ": its header says that a journal belongs to it, but ", path,
      "-wal is missing or empty: the file is an incomplete copy, or a hard link to a file whose "
      "journal lies beside its other name",
      several,
      ", or another SQLite program closed it after a kill. Copy the database again, with its -wal; "
      "if no -wal exists any more, `irsig doctor --accept ",
      name, "` reads all of it, lists the jobs without rows and makes it a plain file"));
}

absl::Status check_has_one_name(const std::string& name, const std::string& path) {
  const std::uint64_t names = names_of(path);
  if (names <= 1) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      name, ": has ", names,
      " hard links, and cannot be written: its journal would lie beside one name only, and whoever "
      "opens another name would miss what stands in it. `find / -xdev -samefile ",
      path, "` lists the names: remove the others, or make this one a file of its own: `cp ", path,
      " ", path, ".own && mv ", path, ".own ", path, "`"));
}

}  // namespace irsig
