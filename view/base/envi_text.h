#pragma once

#include <string>

namespace irsig {

// Returns a value for a list in an ENVI header, in which braces, commas and ends of lines separate:
// each of these characters becomes "_".
[[nodiscard]] std::string envi_text(std::string text);

}  // namespace irsig
