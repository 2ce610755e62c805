#include "core/base/user_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(other.number_) { other.number_ = -1; }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor& operator=(Descriptor&&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
};

absl::Status of_errno() { return absl::InvalidArgumentError(std::strerror(errno)); }

absl::Status check_regular(const struct stat& file) {
  if (S_ISREG(file.st_mode)) return absl::OkStatus();
  const char* what = S_ISDIR(file.st_mode)    ? "folder"
                     : S_ISFIFO(file.st_mode) ? "FIFO"
                     : S_ISSOCK(file.st_mode) ? "socket"
                                              : "device";
  return absl::InvalidArgumentError(absl::StrCat("is a ", what, ", expected a regular file"));
}

struct Opened {
  Descriptor descriptor;
  std::uint64_t bytes;
};

// Looked at before it is opened, since opening alone moves some devices; and afterwards, since the
// name may stand for something else by then. O_NONBLOCK: then even a FIFO opens at once.
absl::StatusOr<Opened> open_regular(const std::string& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) {
    const absl::Status status = of_errno();
    if (path.find('\\') == path.npos) return status;
    return absl::InvalidArgumentError(absl::StrCat(
        status.message(), ": the name has a backslash, expected \"/\" between folders"));
  }
  RETURN_IF_ERROR(check_regular(file));
  Descriptor opened(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (opened.number() < 0 || ::fstat(opened.number(), &file) != 0) return of_errno();
  RETURN_IF_ERROR(check_regular(file));
  return Opened{std::move(opened), static_cast<std::uint64_t>(file.st_size)};
}

// Returns the bytes of the file; an error if there are more than most_bytes.
absl::StatusOr<std::string> read_most(const Opened& file, std::uint64_t most_bytes) {
  constexpr std::uint64_t kStep = 1 << 16;
  std::string out;
  out.reserve(std::min(file.bytes, most_bytes) + 1);
  for (;;) {
    const std::size_t had = out.size();
    // One byte more than there should be finds the end; the size of a file in /proc is 0.
    const std::uint64_t step = file.bytes > had ? file.bytes - had + 1 : kStep;
    out.resize(had + std::min(step, most_bytes - had));
    if (out.size() == had) return out;
    const ssize_t got = ::read(file.descriptor.number(), out.data() + had, out.size() - had);
    if (got < 0 && errno != EINTR) return of_errno();
    out.resize(had + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (got == 0) return out;
  }
}

}  // namespace

absl::StatusOr<std::string> read_user_file(const std::string& path, std::uint64_t most_bytes) {
  ASSIGN_OR_RETURN(const Opened file, open_regular(path));
  if (file.bytes > most_bytes)
    return absl::InvalidArgumentError(
        absl::StrCat("has ", file.bytes, " bytes, expected at most ", most_bytes));
  absl::StatusOr<std::string> bytes = read_most(file, most_bytes + 1);
  if (bytes.ok() && bytes->size() > most_bytes)
    return absl::InvalidArgumentError(
        absl::StrCat("has more than ", most_bytes, " bytes, expected at most so many"));
  return bytes;
}

absl::StatusOr<std::string> read_file_beside(const std::string& naming_file,
                                             const std::string& name, std::uint64_t most_bytes) {
  const std::filesystem::path folder = std::filesystem::path(naming_file).parent_path();
  auto bytes = read_user_file((folder / name).string(), most_bytes);
  if (bytes.ok() || folder.empty() || std::filesystem::path(name).is_absolute()) return bytes;
  return absl::InvalidArgumentError(
      absl::StrCat(bytes.status().message(), " (looked for beside ", naming_file, ")"));
}

absl::StatusOr<std::string> front_of_user_file(const std::string& path, std::uint64_t bytes) {
  ASSIGN_OR_RETURN(const Opened file, open_regular(path));
  return read_most(file, bytes);
}

}  // namespace irsig
