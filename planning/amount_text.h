#pragma once

#include <string>

namespace irsig {

// Formats a time: "43 ms", "8.31 s", "1:02:03".
[[nodiscard]] std::string seconds_text(double seconds);
// Formats a size: "38.2 MB".
[[nodiscard]] std::string bytes_text(double bytes);

}  // namespace irsig
