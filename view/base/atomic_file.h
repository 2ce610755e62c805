#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace irsig {

// `write` fills a new file beside `path` (same folder, its name is the argument); when it returns
// OK the file is renamed to `path`, so that `path` is the old file or the complete new one, never a
// half. Otherwise it is removed. A database is never replaced: INVALID_ARGUMENT.
[[nodiscard]] absl::Status replace_file(
    const std::string& path, const std::function<absl::Status(const std::string&)>& write);
[[nodiscard]] absl::Status replace_file(const std::string& path, std::string_view bytes);

// Removes what calls of `replace_file` for `path` left beside it when their processes were killed.
// For a caller that is alone in the folder: a call that still writes would lose its file.
void remove_left_beside(const std::string& path);

// "cannot write PATH: reason" after a stream of the standard library failed: the reason is `errno`,
// which is 0 before the first write. INVALID_ARGUMENT where the user mends it (a folder that is not
// there, no permission), else UNAVAILABLE (a full disk).
[[nodiscard]] absl::Status write_failure(const std::string& path);

}  // namespace irsig
