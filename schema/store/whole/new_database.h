#pragma once

#include <functional>
#include <string>

#include "absl/status/status.h"

namespace irsig {

// Makes a database that appears complete or not at all: `fill` makes it under the given name beside
// `to`, and leaves one plain file. INVALID_ARGUMENT: `to` exists, or the error of fill.
[[nodiscard]] absl::Status make_new_database(
    const std::string& to, const std::function<absl::Status(const std::string& beside)>& fill);

// Creates an empty database of the newest format as one plain file that only its owner can read.
[[nodiscard]] absl::Status make_empty_database(const std::string& path);

}  // namespace irsig
