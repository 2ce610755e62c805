#pragma once

#include <cstddef>
#include <span>

namespace irsig {

// Position of `at` in strictly increasing abscissae: x = (1 - fraction) x[index] + fraction x[index
// + 1].
struct TablePosition {
  std::size_t index;  // 0 .. x.size() - 2
  double fraction;    // [0, 1]
};

// Finite and strictly increasing, at least two of them: what the functions below require.
[[nodiscard]] bool is_abscissa(std::span<const double> x);

// x.front() <= at <= x.back() is the caller's to guarantee: outside there is no position, and what
// stands in for it (0, the edge value, an error) is a decision of physics.
[[nodiscard]] TablePosition locate(std::span<const double> x, double at);

// Like locate(), for x = first + i step, i = 0 .. count - 1, without a search.
[[nodiscard]] TablePosition locate_uniform(double first, double step, std::size_t count, double at);

// Exactly y[i] at x[i]; between two points never outside their two values.
[[nodiscard]] double interpolate(std::span<const double> y, TablePosition position);

// interpolate(y, locate(x, at)) inside the table; `outside` beyond its ends and for a NaN.
[[nodiscard]] double interpolate_or(std::span<const double> x, std::span<const double> y, double at,
                                    double outside);

}  // namespace irsig
