#pragma once

#include <string>
#include <vector>

namespace irsig {

// A linear axis with round ticks that covers [low, high].
struct Axis {
  double low, high;
  std::vector<double> tick;
  std::vector<std::string> label;  // one for each tick, all with the same number of decimals

  [[nodiscard]] double fraction(double value) const { return (value - low) / (high - low); }
};

// The unit in which values up to `largest` are labelled with few digits: "kW/sr" and 1e-3 for 2e5
// W/sr.
struct DisplayUnit {
  std::string name;
  double factor;  // label = value x factor
};
[[nodiscard]] DisplayUnit display_unit(double largest, const std::string& unit);

// Returns an axis of about `ticks` steps of 1, 2, 2.5 or 5 x 10^n, with ticks at both ends. If low
// == high, the axis is widened.
[[nodiscard]] Axis round_axis(double low, double high, int ticks, double label_factor = 1);

// Returns the ticks inside [low, high], which are kept as the ends.
[[nodiscard]] Axis tight_axis(double low, double high, int ticks);

}  // namespace irsig
