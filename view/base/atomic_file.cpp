#include "view/base/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace irsig {
namespace {

absl::Status failed(const std::string& path, int error) {
  const std::string text = fmt::format("cannot write {}: {}", path, std::strerror(error));
  // A folder that is not there or is not ours is the user's to mend; a full disk is not.
  if (error == ENOENT || error == EACCES || error == EPERM || error == ENOTDIR || error == EISDIR ||
      error == EROFS || error == ENAMETOOLONG || error == ELOOP)
    return absl::InvalidArgumentError(text);
  return absl::UnavailableError(text);
}

// Hours of computing are not replaced by a table.
bool is_database(const std::string& path) {
  constexpr std::string_view kMagic = "SQLite format 3";
  std::string head(kMagic.size(), '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  return file && head == kMagic;
}

// A rename would put a file in the place of a device or a FIFO, for all who use it.
absl::Status refuse_what_is_no_file(const std::string& path) {
  std::error_code unknown;  // then opening says why
  const std::filesystem::file_status of = std::filesystem::status(path, unknown);
  if (std::filesystem::is_directory(of)) return failed(path, EISDIR);
  if (std::filesystem::exists(of) && !std::filesystem::is_regular_file(of))
    return absl::InvalidArgumentError(fmt::format(
        "cannot write {}: it is a device, a FIFO or a socket, expected the name of a file", path));
  return absl::OkStatus();
}

}  // namespace

absl::Status replace_file(const std::string& path,
                          const std::function<absl::Status(const std::string&)>& write) {
  if (absl::Status no_file = refuse_what_is_no_file(path); !no_file.ok()) return no_file;
  if (is_database(path))
    return absl::InvalidArgumentError(
        fmt::format("cannot write {}: it is a database, expected another name", path));
  const std::string beside = fmt::format("{}.{}.partial", path, ::getpid());
  const int fd = ::open(beside.c_str(), O_CREAT | O_WRONLY | O_TRUNC | O_CLOEXEC, 0666);
  if (fd < 0) return failed(path, errno);
  ::close(fd);
  absl::Status status = write(beside);
  if (status.ok() && std::rename(beside.c_str(), path.c_str()) != 0) status = failed(path, errno);
  if (!status.ok()) std::remove(beside.c_str());
  return status;
}

absl::Status replace_file(const std::string& path, std::string_view bytes) {
  return replace_file(path, [&](const std::string& beside) -> absl::Status {
    errno = 0;
    std::ofstream file(beside, std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) return write_failure(path);
    return absl::OkStatus();
  });
}

void remove_left_beside(const std::string& path) {
  namespace fs = std::filesystem;
  const fs::path whole(path);
  const std::string start = whole.filename().string() + ".";
  constexpr std::string_view kEnd = ".partial";
  std::error_code ended;  // a folder that cannot be read keeps what it has
  for (fs::directory_iterator at(whole.has_parent_path() ? whole.parent_path() : ".", ended), end;
       !ended && at != end; at.increment(ended)) {
    const std::string name = at->path().filename().string();
    if (name.size() <= start.size() + kEnd.size() || !name.starts_with(start) ||
        !name.ends_with(kEnd))
      continue;
    const std::string_view process =
        std::string_view(name).substr(start.size(), name.size() - start.size() - kEnd.size());
    std::error_code stays;
    if (process.find_first_not_of("0123456789") == std::string_view::npos)
      fs::remove(at->path(), stays);
  }
}

absl::Status write_failure(const std::string& path) {
  return failed(path, errno != 0 ? errno : EIO);
}

}  // namespace irsig
