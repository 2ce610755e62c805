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

// Returns true if the numbers are finite, strictly increasing and at least two, as the functions
// below require.
[[nodiscard]] bool is_abscissa(std::span<const double> x);

// Finds the position of a number in the table. The caller guarantees x.front() <= at <= x.back(),
// since the value beyond the ends (0, the edge's value, an error) is a decision of physics.
[[nodiscard]] TablePosition locate(std::span<const double> x, double at);

// Like locate(), for x = first + i step, i = 0 .. count - 1, without a search.
[[nodiscard]] TablePosition locate_uniform(double first, double step, std::size_t count, double at);

// Interpolates linearly: exactly y[i] at x[i], and between two points never outside their values.
[[nodiscard]] double interpolate(std::span<const double> y, TablePosition position);

// Returns interpolate(y, locate(x, at)) inside the table, and `outside` beyond its ends and for a
// NaN.
[[nodiscard]] double interpolate_or(std::span<const double> x, std::span<const double> y, double at,
                                    double outside);

}  // namespace irsig
