#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace irsig {

// Replaces a file atomically. `write` gets the name of a new file in the folder of `path` and fills
// it; if `write` returns OK, the new file is renamed to `path`, and otherwise removed. `path` is
// therefore the old file or the complete new one. INVALID_ARGUMENT: `path` is a database, a
// device, a FIFO or a socket, which are never replaced.
[[nodiscard]] absl::Status replace_file(
    const std::string& path, const std::function<absl::Status(const std::string&)>& write);
[[nodiscard]] absl::Status replace_file(const std::string& path, std::string_view bytes);

// Removes the files that calls of `replace_file` for `path` left beside it when their processes
// were killed. The caller must be alone in the folder: a running call would lose its file.
void remove_left_beside(const std::string& path);

// Returns the error "cannot write PATH: reason" after a stream of the standard library failed. The
// reason is `errno`, which must be 0 before the first write. INVALID_ARGUMENT where the user can
// correct it (missing folder, no permission), else UNAVAILABLE (full disk).
[[nodiscard]] absl::Status write_failure(const std::string& path);

}  // namespace irsig
