#include "coordinator/client/scratch_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "absl/strings/str_cat.h"

namespace irsig {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrefix = "irsig-scratch-";
constexpr std::size_t kRandomLetters = 6;
constexpr const char* kLock = "/in-use";  // a folder without this file is none of ours

// A lock on the folder's file, which lies where it is named; -1: somebody else's, or no such file.
int lock_folder(const std::string& folder, int further_flags) {
  const std::string path = folder + kLock;
  const int descriptor =
      open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | further_flags, 0600);
  if (descriptor < 0) return -1;
  struct stat held {
  }, named{};
  if (flock(descriptor, LOCK_EX | LOCK_NB) == 0 && fstat(descriptor, &held) == 0 &&
      lstat(path.c_str(), &named) == 0 && held.st_ino == named.st_ino &&
      held.st_dev == named.st_dev) {
    return descriptor;
  }
  close(descriptor);
  return -1;
}

// Removes folders that killed processes of this user left in the same place. Errors are ignored:
// nothing here is worth a failure.
void remove_abandoned(const fs::path& place) {
  std::error_code error;
  for (fs::directory_iterator at(place, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (!name.starts_with(kPrefix) || name.size() != std::strlen(kPrefix) + kRandomLetters)
      continue;
    struct stat folder {};
    if (lstat(at->path().c_str(), &folder) != 0 || !S_ISDIR(folder.st_mode) ||
        folder.st_uid != geteuid())
      continue;
    const int lock = lock_folder(at->path().string(), 0);
    if (lock < 0) continue;
    std::error_code ignored;
    fs::remove_all(at->path(), ignored);
    close(lock);
  }
}

}  // namespace

absl::StatusOr<std::unique_ptr<ScratchFolder>> ScratchFolder::make(std::size_t longest_path) {
  const char* chosen = std::getenv("TMPDIR");
  const std::size_t added = std::strlen(kPrefix) + kRandomLetters + 1;
  std::string place = chosen != nullptr && *chosen != '\0' ? chosen : "/tmp";
  if (place.size() + added > longest_path) place = "/tmp";
  return make_in(place);
}

absl::StatusOr<std::unique_ptr<ScratchFolder>> ScratchFolder::make_in(const std::string& place) {
  remove_abandoned(place);
  for (;;) {
    std::string folder = absl::StrCat(place, "/", kPrefix, std::string(kRandomLetters, 'X'));
    if (mkdtemp(folder.data()) == nullptr) {
      return absl::InternalError(
          absl::StrCat("cannot make a private folder ", folder, ": ", std::strerror(errno)));
    }
    const int lock = lock_folder(folder, O_CREAT | O_EXCL);
    if (lock >= 0) return std::unique_ptr<ScratchFolder>(new ScratchFolder(folder, lock));
    // Taken for abandoned between its making and its locking, and removed: once more.
    if (errno == EWOULDBLOCK || errno == ENOENT) continue;
    return absl::InternalError(
        absl::StrCat("cannot write into ", folder, ": ", std::strerror(errno)));
  }
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;  // a leftover is no reason to fail
  fs::remove_all(path_, ignored);
  close(lock_);
}

}  // namespace irsig
