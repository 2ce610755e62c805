#include "core/base/ordered_dot.h"

#include "core/base/clones.h"

namespace irsig {

IRSIG_CLONES double long_ordered_dot(const double* a, const double* b, std::size_t n) {
  constexpr std::size_t kLanes = 16;
  double part[kLanes] = {};
  std::size_t i = 0;
  for (; i + kLanes <= n; i += kLanes)
    for (std::size_t k = 0; k < kLanes; ++k) part[k] += a[i + k] * b[i + k];
  for (std::size_t k = 0; i < n; ++i, ++k) part[k] += a[i] * b[i];
  double sum = 0;
  for (const double p : part) sum += p;
  return sum;
}

}  // namespace irsig
