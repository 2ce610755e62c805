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

// Reads a file that a user names; all such files are opened here. Reads only regular files and
// links to them, since others may have no end (devices) or never begin (a FIFO), and never more
// than most_bytes, even if the file grows meanwhile. INVALID_ARGUMENT states the reason, without
// the file's name.
[[nodiscard]] absl::StatusOr<std::string> read_user_file(const std::string& path,
                                                         std::uint64_t most_bytes);

// Like read_user_file(), for a file that another file names. The name is relative to the folder of
// the naming file, which errors mention.
[[nodiscard]] absl::StatusOr<std::string> read_file_beside(const std::string& naming_file,
                                                           const std::string& name,
                                                           std::uint64_t most_bytes);

// Returns the first bytes of such a file, at most `bytes`, whatever the file's size.
[[nodiscard]] absl::StatusOr<std::string> front_of_user_file(const std::string& path,
                                                             std::uint64_t bytes);

}  // namespace irsig
