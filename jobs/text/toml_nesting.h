#pragma once

#include <string_view>

#include "absl/status/status.h"

namespace irsig {

// Refuses a TOML text with more than 32 parts in a dotted key or 32 open brackets before it is
// parsed. The parser makes a table of each part and destroys tables by recursion, so that a key of
// 100 000 parts ends the program. Sweep files have three levels. INVALID_ARGUMENT with
// file:line:column of the first place that is too deep. Text that is not TOML is left for the
// parser to report.
[[nodiscard]] absl::Status check_toml_nesting(std::string_view text, std::string_view file_name);

}  // namespace irsig
