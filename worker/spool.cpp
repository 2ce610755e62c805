#include "worker/spool.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "coordinator/client/farm_log.h"
#include "jobs/keys/expand.h"

namespace irsig {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic = "irsigsp1";
constexpr std::size_t kHeadBytes = 16, kHashBytes = 64;
constexpr std::size_t kNameDigits = 32;
constexpr char kEnding[] = ".result", kDraftEnding[] = ".new-";

absl::Status failed(const std::string& path, const char* what) {
  return absl::InternalError(absl::StrCat(path, ": ", what, ": ", std::strerror(errno)));
}

std::string framed(const std::string& record) {
  std::string out(kMagic);
  for (int byte = 0; byte < 8; ++byte) out += static_cast<char>(record.size() >> (8 * byte) & 0xff);
  out += record;
  return out + sha256_hex(out);
}

// Empty: torn.
std::optional<schema::SpooledResult> unframed(std::string_view bytes) {
  if (bytes.size() < kHeadBytes + kHashBytes || !bytes.starts_with(kMagic)) return std::nullopt;
  std::uint64_t length = 0;
  for (std::size_t byte = 0; byte < 8; ++byte)
    length |= std::uint64_t{static_cast<unsigned char>(bytes[8 + byte])} << (8 * byte);
  if (length != bytes.size() - kHeadBytes - kHashBytes) return std::nullopt;
  const std::string_view before = bytes.substr(0, bytes.size() - kHashBytes);
  if (sha256_hex(before) != bytes.substr(before.size())) return std::nullopt;
  schema::SpooledResult record;
  if (!record.ParseFromArray(before.data() + kHeadBytes, static_cast<int>(length)))
    return std::nullopt;
  return record;
}

std::optional<std::string> read_all(int fd) {
  struct stat info {};
  if (fstat(fd, &info) != 0 || !S_ISREG(info.st_mode) || info.st_size < 0 ||
      info.st_size > (std::int64_t{1} << 30))
    return std::nullopt;
  std::string bytes(static_cast<std::size_t>(info.st_size), '\0');
  std::size_t at = 0;
  while (at < bytes.size()) {
    const ssize_t got = pread(fd, bytes.data() + at, bytes.size() - at, static_cast<off_t>(at));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return std::nullopt;
    at += static_cast<std::size_t>(got);
  }
  return bytes;
}

bool write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t put = write(fd, bytes.data(), bytes.size());
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(put));
  }
  return true;
}

// The file of this name, locked; -1: it belongs to somebody, or is gone.
int lock_file(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (fd < 0) return -1;
  struct stat there {
  }, ours{};
  // It may have been removed between the two.
  if (flock(fd, LOCK_EX | LOCK_NB) == 0 && fstat(fd, &ours) == 0 &&
      stat(path.c_str(), &there) == 0 && there.st_ino == ours.st_ino)
    return fd;
  close(fd);
  return -1;
}

enum class Ours { kNot, kRecord, kDraft };
Ours kind_of(std::string_view name) {
  const auto all = [](std::string_view text, std::string_view of) {
    return !text.empty() && text.find_first_not_of(of) == std::string_view::npos;
  };
  if (name.size() < kNameDigits || !all(name.substr(0, kNameDigits), "0123456789abcdef"))
    return Ours::kNot;
  const std::string_view ending = name.substr(kNameDigits);
  if (ending == kEnding) return Ours::kRecord;
  if (ending.starts_with(kDraftEnding) &&
      all(ending.substr(std::size(kDraftEnding) - 1), "0123456789"))
    return Ours::kDraft;
  return Ours::kNot;
}

// Records and drafts of the folder, the oldest first; whatever else lies there is somebody's.
std::vector<fs::path> files_in(const std::string& folder) {
  std::vector<std::pair<fs::file_time_type, fs::path>> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (kind_of(entry.path().filename().string()) == Ours::kNot) continue;
    const auto time = entry.last_write_time(error);
    if (!error) found.emplace_back(time, entry.path());
  }
  std::sort(found.begin(), found.end());
  std::vector<fs::path> out;
  for (auto& [time, path] : found) out.push_back(std::move(path));
  return out;
}

}  // namespace

absl::StatusOr<std::unique_ptr<Spool>> Spool::open(const std::string& folder,
                                                   std::uint64_t most_bytes, AtStep at_step) {
  const auto wrong = [&](const std::string& what) {
    return absl::InvalidArgumentError(absl::StrCat("--spool ", folder, ": ", what));
  };
  if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) return wrong(std::strerror(errno));
  struct stat info {};
  if (stat(folder.c_str(), &info) != 0) return wrong(std::strerror(errno));
  if (!S_ISDIR(info.st_mode)) return wrong("is no folder");
  if (info.st_uid != geteuid() || (info.st_mode & 022U) != 0)
    return wrong("others may write to it, expected a folder of its owner alone (mode 0700)");
  std::unique_ptr<Spool> spool(new Spool(folder, most_bytes, std::move(at_step)));
  // Removes drafts of processes that died while they were writing.
  for (const fs::path& file : files_in(folder)) {
    if (kind_of(file.filename().string()) != Ours::kDraft) continue;
    const int fd = lock_file(file);
    if (fd < 0) continue;
    unlink(file.c_str());
    close(fd);
  }
  return spool;
}

Spool::~Spool() {
  for (const Held& held : held_) close(held.fd);
}

bool Spool::make_room(std::uint64_t bytes) {
  std::uint64_t taken = 0;
  std::error_code error;
  std::vector<std::pair<fs::path, std::uint64_t>> files;
  for (const fs::path& file : files_in(folder_)) {
    const std::uint64_t size = fs::file_size(file, error);
    if (error) continue;
    taken += size;
    files.emplace_back(file, size);
  }
  for (const auto& [file, size] : files) {
    if (taken + bytes <= most_bytes_) break;
    const int fd = lock_file(file);
    if (fd < 0) continue;
    log_line(LogLevel::warn, {}, "spool: {} makes room for a newer result",
             file.filename().string());
    unlink(file.c_str());
    close(fd);
    taken -= size;
  }
  return taken + bytes <= most_bytes_;
}

void Spool::sync_folder() const {
  const int fd = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  fsync(fd);
  close(fd);
}

absl::StatusOr<std::string> Spool::keep(const schema::SpooledResult& record) {
  const std::string bytes = framed(record.SerializeAsString());
  const std::string base =
      sha256_hex(absl::StrCat(record.sweep_sha256(), record.job_key(), sha256_hex(record.result())))
          .substr(0, kNameDigits);
  const std::string name = absl::StrCat(base, kEnding);
  if (!make_room(bytes.size()))
    return absl::ResourceExhaustedError(
        absl::StrCat("the spool ", folder_, " has no room for ", bytes.size(), " bytes more"));
  const std::string draft = path(absl::StrCat(base, kDraftEnding, getpid()));
  const int fd = ::open(draft.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (fd < 0) return failed(draft, "cannot be made");
  const auto give_up = [&](const char* what) {
    const absl::Status status = failed(draft, what);
    unlink(draft.c_str());
    close(fd);
    return status;
  };
  if (flock(fd, LOCK_EX | LOCK_NB) != 0) return give_up("cannot be locked");
  step(Step::kCreated);
  if (!write_all(fd, bytes)) return give_up("cannot be written");
  step(Step::kWritten);
  if (fsync(fd) != 0) return give_up("cannot be synced");
  step(Step::kSynced);
  if (rename(draft.c_str(), path(name).c_str()) != 0) return give_up("cannot be renamed");
  step(Step::kNamed);
  sync_folder();
  held_.push_back({name, fd});
  step(Step::kKept);
  return name;
}

std::vector<Spool::Found> Spool::take_over(
    const std::function<bool(const schema::SpooledResult&)>& mine) {
  std::vector<Found> out;
  for (const fs::path& file : files_in(folder_)) {
    const std::string name = file.filename();
    if (kind_of(name) != Ours::kRecord) continue;
    if (std::any_of(held_.begin(), held_.end(), [&](const Held& h) { return h.name == name; }))
      continue;
    const int fd = lock_file(file);
    if (fd < 0) continue;
    const auto bytes = read_all(fd);
    auto record = bytes ? unframed(*bytes) : std::nullopt;
    if (!record) {
      log_line(LogLevel::warn, {}, "spool: {} is torn: removed; its job is computed again", name);
      unlink(file.c_str());
    } else if (mine(*record)) {
      held_.push_back({name, fd});
      out.push_back({name, *std::move(record)});
      continue;
    }
    close(fd);
  }
  return out;
}

void Spool::remove(const std::string& name) {
  unlink(path(name).c_str());
  step(Step::kRemoved);
  sync_folder();
  leave(name);
  step(Step::kForgotten);
}

void Spool::leave(const std::string& name) {
  const auto held =
      std::find_if(held_.begin(), held_.end(), [&](const Held& one) { return one.name == name; });
  if (held == held_.end()) return;
  close(held->fd);
  held_.erase(held);
}

}  // namespace irsig
