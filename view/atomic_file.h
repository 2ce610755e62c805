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

}  // namespace irsig
