#pragma once

#include <string_view>

namespace irsig {

// Returns true if a spreadsheet would take a cell with this text for a formula, which can run
// commands: the text begins with = + - @, a tab or a return, and is not a number.
[[nodiscard]] bool is_formula(std::string_view text);

}  // namespace irsig
