#include "view/plot/hour_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace irsig {

Axis hour_axis(double first_h, double last_h) {
  const double low = std::min(0.0, std::floor(first_h)), high = std::max(0.0, std::ceil(last_h));
  Axis axis{low, std::max(high, low + 24), {}, {}};
  for (double tick = std::ceil(low / 3) * 3; tick <= axis.high; tick += 3) {
    axis.tick.push_back(tick);
    axis.label.push_back(fmt::format("{:02}", (static_cast<int>(tick) + 48) % 24));
  }
  return axis;
}

std::string hour_label(const std::optional<double>& solar_offset_h) {
  if (!solar_offset_h) return "UTC in h";
  return fmt::format("Local mean solar time in h (UTC {} {:.2f} h)",
                     *solar_offset_h < 0 ? "\u2212" : "+", std::abs(*solar_offset_h));
}

}  // namespace irsig
