#pragma once

#include <cstddef>

namespace irsig {

// Sum of a[i] b[i]. Its order is fixed by n alone: the same bits on every machine. From 32 numbers
// on in sixteen partial sums, which can be kept in vectors; below, that would cost more than it
// saves.
[[nodiscard]] double long_ordered_dot(const double* a, const double* b, std::size_t n);

[[nodiscard]] inline double ordered_dot(const double* a, const double* b, std::size_t n) {
  if (n >= 32) return long_ordered_dot(a, b, n);
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace irsig
