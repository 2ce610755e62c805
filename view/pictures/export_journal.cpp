#include "view/pictures/export_journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>

#include "absl/strings/cord.h"

namespace irsig {

std::string Journal::text() const {
  std::string out = fmt::format("{}\n{} {} {} {} {} {}\n", asked, seen, painted, images,
                                annotations, fmt::join(bytes, " "), hottest.size());
  for (const auto& [of, value] : hottest)
    out += fmt::format("{}\n{}\n{:.17g}\n", of.first, of.second, value);
  return out;
}

std::optional<Journal> Journal::read(const std::string& path) {
  std::ifstream file(path);
  Journal out;
  std::size_t scales = 0;
  std::string line;
  const auto rest = [&] { std::getline(file, line); };
  if (!std::getline(file, out.asked)) return std::nullopt;
  file >> out.seen >> out.painted >> out.images >> out.annotations;
  for (std::uint64_t& b : out.bytes) file >> b;
  file >> scales;
  rest();
  for (std::size_t i = 0; i < scales && file; ++i) {
    SweepBand of;
    std::getline(file, of.first);
    std::getline(file, of.second);
    file >> out.hottest[of];
    rest();
  }
  if (!file) return std::nullopt;
  return out;
}

absl::Status Journal::cut_back(const std::string& folder) const {
  namespace fs = std::filesystem;
  for (std::size_t i = 0; i < kGrowing.size(); ++i) {
    const std::string path = folder + "/" + kGrowing[i];
    std::error_code error;
    const std::uintmax_t there = fs::file_size(path, error);
    if (error && bytes[i] == 0) continue;
    if (error) return cannot_make(path, error);
    if (there < bytes[i])
      return absl::InvalidArgumentError(fmt::format(
          "{}: is shorter than the export before has left it: remove {}", path, folder));
    fs::resize_file(path, bytes[i], error);
    if (error) return cannot_make(path, error);
  }
  return absl::OkStatus();
}

namespace {
constexpr const char* kFinal = "irsig/final";
}  // namespace

absl::Status final_end(absl::Status why) {
  if (!why.ok()) why.SetPayload(kFinal, absl::Cord());
  return why;
}

bool is_final(const absl::Status& why) { return why.GetPayload(kFinal).has_value(); }

absl::Status cannot_make(const std::string& path, const std::error_code& error) {
  const std::string text = fmt::format("cannot make {}: {}", path, error.message());
  return error == std::errc::no_space_on_device ? absl::ResourceExhaustedError(text)
                                                : absl::InvalidArgumentError(text);
}

absl::StatusOr<std::unique_ptr<FolderLock>> FolderLock::take(const std::string& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return cannot_make(folder, std::error_code(errno, std::generic_category()));
  std::unique_ptr<FolderLock> lock(new FolderLock(descriptor));
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0)
    return absl::FailedPreconditionError(
        fmt::format("{}: another irsig is writing this folder", folder));
  return lock;
}

FolderLock::~FolderLock() { ::close(descriptor_); }

}  // namespace irsig
