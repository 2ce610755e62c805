#include "schema/store/tables/spooled_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "schema/store/tables/sha256.h"

namespace irsig {
namespace {

class UnnamedFile final : public SpooledFile {
 public:
  explicit UnnamedFile(int descriptor) : descriptor_(descriptor) {}
  ~UnnamedFile() override { ::close(descriptor_); }

  absl::Status append(std::string_view bytes) override {
    hash_.add(bytes);
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0)
        return absl::OutOfRangeError(
            absl::StrCat("a file of the submission cannot be kept: ", std::strerror(errno)));
      bytes.remove_prefix(static_cast<std::size_t>(written));
      size_ += static_cast<std::uint64_t>(written);
    }
    return absl::OkStatus();
  }

  [[nodiscard]] std::uint64_t size() const override { return size_; }

  std::string sha256() override {
    if (hex_.empty()) hex_ = hash_.hex();
    return hex_;
  }

  absl::StatusOr<std::string> read(std::uint64_t at, std::size_t most) const override {
    std::string bytes(most, '\0');
    const ssize_t got = ::pread(descriptor_, bytes.data(), most, static_cast<off_t>(at));
    if (got < 0)
      return absl::InternalError(
          absl::StrCat("a file of the submission cannot be read: ", std::strerror(errno)));
    bytes.resize(static_cast<std::size_t>(got));
    return bytes;
  }

 private:
  int descriptor_;
  std::uint64_t size_ = 0;
  Sha256 hash_;
  std::string hex_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<SpooledFile>> SpooledFile::make(const std::string& folder) {
  int descriptor = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor < 0) {  // a file system that has none without a name
    std::string name = folder + "/irsig-spool-XXXXXX";
    descriptor = ::mkostemp(name.data(), O_CLOEXEC);
    if (descriptor >= 0) ::unlink(name.c_str());
  }
  if (descriptor < 0)
    return absl::OutOfRangeError(absl::StrCat(
        folder, ": a file of the submission cannot be kept there: ", std::strerror(errno)));
  return std::make_unique<UnnamedFile>(descriptor);
}

}  // namespace irsig
