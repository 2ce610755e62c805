#include "core/thermal/scene/day_response.h"

#include <algorithm>
#include <cmath>

namespace irsig {

DayResponse::DayResponse(std::span<const double> end_k, std::size_t nodes)
    : nodes_(nodes), inverse_(nodes * nodes) {
  // A wall that gives nothing away keeps what it has: its day never returns. This much is lost.
  constexpr double kKept = 1 - 1e-6;
  const std::size_t n = nodes;
  std::vector<double> left(n *
                           n);  // 1 - A, turned into 1 by rows while inverse_ becomes what it says
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      left[i * n + j] = (i == j ? 1 : 0) - kKept * (end_k[(j + 1) * n + i] - end_k[i]) / kProbeK;
      inverse_[i * n + j] = i == j ? 1 : 0;
    }
  for (std::size_t c = 0; c < n; ++c) {
    std::size_t pivot = c;
    for (std::size_t i = c + 1; i < n; ++i)
      if (std::abs(left[i * n + c]) > std::abs(left[pivot * n + c])) pivot = i;
    for (std::size_t j = 0; j < n; ++j) {
      std::swap(left[c * n + j], left[pivot * n + j]);
      std::swap(inverse_[c * n + j], inverse_[pivot * n + j]);
    }
    const double over = 1 / left[c * n + c];
    for (std::size_t j = 0; j < n; ++j) {
      left[c * n + j] *= over;
      inverse_[c * n + j] *= over;
    }
    for (std::size_t i = 0; i < n; ++i) {
      const double factor = left[i * n + c];
      if (i == c || factor == 0) continue;
      for (std::size_t j = 0; j < n; ++j) {
        left[i * n + j] -= factor * left[c * n + j];
        inverse_[i * n + j] -= factor * inverse_[c * n + j];
      }
    }
  }
}

void DayResponse::go_on(std::span<double> change_k) const {
  const std::vector<double> change(change_k.begin(), change_k.end());
  for (std::size_t i = 0; i < nodes_; ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < nodes_; ++j) sum += inverse_[i * nodes_ + j] * change[j];
    change_k[i] = sum;
  }
}

}  // namespace irsig
