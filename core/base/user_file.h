#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"

namespace irsig {

// The most bytes of a file, by what it is for. Above them it is refused before it is read. A sweep
// file takes up to 180 times its size in memory (a line for each key), the others a few times
// theirs.
inline constexpr std::uint64_t kMostSpecBytes = 8'000'000;       // a sweep or goniometer file
inline constexpr std::uint64_t kMostTableBytes = 64'000'000;     // optical data, weather, spectra
inline constexpr std::uint64_t kMostModelBytes = 1'000'000'000;  // what a coordinator takes

// The content of a file that a user names: whatever opens one opens it here. Only a regular file
// (or a link to one) is read, since others may have no end (devices) or never begin (a FIFO), and
// never more than most_bytes, even where it grows meanwhile. INVALID_ARGUMENT says why it cannot be
// had, without the file's name.
[[nodiscard]] absl::StatusOr<std::string> read_user_file(const std::string& path,
                                                         std::uint64_t most_bytes);

// Like read_user_file(), for a file that another file names. The name is relative to the folder of
// the naming file, which errors mention.
[[nodiscard]] absl::StatusOr<std::string> read_file_beside(const std::string& naming_file,
                                                           const std::string& name,
                                                           std::uint64_t most_bytes);

// The first bytes of such a file, at most so many, whatever its size.
[[nodiscard]] absl::StatusOr<std::string> front_of_user_file(const std::string& path,
                                                             std::uint64_t bytes);

}  // namespace irsig
