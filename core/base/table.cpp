#include "core/base/table.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace irsig {

bool is_abscissa(std::span<const double> x) {
  if (x.size() < 2 || !std::isfinite(x.front()) || !std::isfinite(x.back())) return false;
  return std::adjacent_find(x.begin(), x.end(), [](double a, double b) { return !(a < b); }) ==
         x.end();
}

TablePosition locate(std::span<const double> x, double at) {
  IRSIG_CHECK(x.size() >= 2);
  IRSIG_CHECK(at >= x.front());
  IRSIG_CHECK(at <= x.back());
  const auto above = std::upper_bound(x.begin() + 1, x.end() - 1, at);
  const auto index = static_cast<std::size_t>(above - x.begin()) - 1;
  return {index, (at - x[index]) / (x[index + 1] - x[index])};
}

TablePosition locate_uniform(double first, double step, std::size_t count, double at) {
  IRSIG_CHECK(count >= 2);
  IRSIG_CHECK(step > 0.0);
  const double steps = (at - first) / step;
  const auto last = static_cast<double>(count - 1);
  // A grid computed as first + i * step may end half a unit in the last place beyond `last` steps.
  constexpr double kRoundingSteps = 1e-9;
  IRSIG_CHECK(steps >= -kRoundingSteps);
  IRSIG_CHECK(steps <= last + kRoundingSteps);
  const double inside = std::clamp(steps, 0.0, last);
  const double cell = std::min(std::floor(inside), last - 1.0);
  return {static_cast<std::size_t>(cell), inside - cell};
}

double interpolate(std::span<const double> y, TablePosition position) {
  IRSIG_CHECK(position.index + 1 < y.size());
  return std::lerp(y[position.index], y[position.index + 1], position.fraction);
}

double interpolate_or(std::span<const double> x, std::span<const double> y, double at,
                      double outside) {
  IRSIG_CHECK(x.size() == y.size());
  if (!(at >= x.front() && at <= x.back())) return outside;
  return interpolate(y, locate(x, at));
}

}  // namespace irsig
