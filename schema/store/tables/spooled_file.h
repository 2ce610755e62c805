#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace irsig {

// Bytes on their way into the database, in a file without a name in the database's folder, so that
// memory holds one piece at a time. The file disappears with this object, however its process ends.
// The SHA-256 is computed as the bytes arrive. Not thread-safe.
class SpooledFile {
 public:
  static absl::StatusOr<std::unique_ptr<SpooledFile>> make(const std::string& folder);
  virtual ~SpooledFile() = default;

  // Appends bytes. OUT_OF_RANGE: there is no space left for them.
  virtual absl::Status append(std::string_view bytes) = 0;
  [[nodiscard]] virtual std::uint64_t size() const = 0;
  // Returns the hash of all bytes; nothing may be appended after.
  virtual std::string sha256() = 0;
  // Reads at most `most` bytes from `at` on.
  virtual absl::StatusOr<std::string> read(std::uint64_t at, std::size_t most) const = 0;
};

}  // namespace irsig
