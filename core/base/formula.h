#pragma once

#include <string_view>

namespace irsig {

// Whether spreadsheets take a cell with this text for a formula, which may call what its author
// likes: it begins with = + - @, a tab or a return, and is no number.
[[nodiscard]] bool is_formula(std::string_view text);

}  // namespace irsig
