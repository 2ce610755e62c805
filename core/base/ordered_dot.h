#pragma once

#include <cstddef>

namespace irsig {

// Returns the sum of a[i] b[i]. The order of summation depends on n alone, so that all machines
// give the same bits. From 32 numbers on the sum has sixteen partial sums, which fit into vectors.
[[nodiscard]] double long_ordered_dot(const double* a, const double* b, std::size_t n);

[[nodiscard]] inline double ordered_dot(const double* a, const double* b, std::size_t n) {
  if (n >= 32) return long_ordered_dot(a, b, n);
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace irsig
