#include "view/draw/axis.h"

#include <fmt/format.h>

#include <cmath>

namespace irsig {
namespace {

double round_step(double span, int ticks) {
  const double raw = span / ticks;
  const double decade = std::pow(10, std::floor(std::log10(raw)));
  for (double m : {1.0, 2.0, 2.5, 5.0}) {
    if (raw <= m * decade * (1 + 1e-9)) return m * decade;
  }
  return 10 * decade;
}

// As many decimals as the step has: 0.05 -> 2, 2.5 -> 1, 20 -> 0.
int decimals_of(double step) {
  for (int d = 0; d < 12; ++d) {
    const double scaled = step * std::pow(10, d);
    if (std::abs(scaled - std::round(scaled)) < 1e-6 * scaled) return d;
  }
  return 12;
}

Axis with_ticks(double low, double high, double step, double label_factor) {
  Axis axis{low, high, {}, {}};
  const double largest = std::max(std::abs(low), std::abs(high)) * label_factor;
  const auto first = static_cast<long>(std::ceil(low / step - 1e-9));
  const auto last = static_cast<long>(std::floor(high / step + 1e-9));
  for (long i = first; i <= last; ++i) {
    const double value = static_cast<double>(i) * step;
    axis.tick.push_back(value);
    const double label = value * label_factor;
    axis.label.push_back(largest >= 1e6 || largest < 1e-3
                             ? fmt::format("{:.3g}", label)
                             : fmt::format("{:.{}f}", label, decimals_of(step * label_factor)));
  }
  return axis;
}

void widen(double& low, double& high) {
  if (high > low) return;
  const double half = low == 0 ? 0.5 : 0.05 * std::abs(low);
  low -= half;
  high += half;
}

}  // namespace

DisplayUnit display_unit(double largest, const std::string& unit) {
  if (largest >= 1e7) return {"M" + unit, 1e-6};
  if (largest >= 1e4) return {"k" + unit, 1e-3};
  if (largest < 1e-2) return {"m" + unit, 1e3};
  return {unit, 1};
}

Axis round_axis(double low, double high, int ticks, double label_factor) {
  widen(low, high);
  const double step = round_step(high - low, ticks);
  return with_ticks(std::floor(low / step + 1e-9) * step, std::ceil(high / step - 1e-9) * step,
                    step, label_factor);
}

Axis tight_axis(double low, double high, int ticks) {
  widen(low, high);
  return with_ticks(low, high, round_step(high - low, ticks), 1);
}

}  // namespace irsig
