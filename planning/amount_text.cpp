#include "planning/amount_text.h"

#include "coordinator/client/progress_text.h"
#include "fmt/format.h"

namespace irsig {

std::string seconds_text(double seconds) {
  if (seconds < 1) return fmt::format("{:.3g} ms", 1e3 * seconds);
  return seconds < 120 ? fmt::format("{:.3g} s", seconds) : duration_text(seconds);
}

std::string bytes_text(double bytes) {
  for (const char* unit : {"B", "kB", "MB", "GB"}) {
    if (bytes < 1000) return fmt::format("{:.3g} {}", bytes, unit);
    bytes /= 1000;
  }
  return fmt::format("{:.3g} TB", bytes);
}

}  // namespace irsig
