#include "core/thermal/scene/radiosity.h"

#include <algorithm>
#include <cmath>

namespace irsig {

void Radiosity::solve(std::span<const double> own, std::span<const double> emitted,
                      double tolerance_w_m2, std::span<double> total) {
  constexpr int kMostRounds = 2000;
  if (factors_.to.empty()) {
    std::copy(own.begin(), own.end(), total.begin());
    return;
  }
  for (std::size_t i = 0; i < total.size(); ++i) {
    if (apart_[i]) total[i] = own[i];
    sent_[i] = emitted[i] + (1 - kept_[i]) * total[i];
  }
  for (int round = 0; round < kMostRounds; ++round) {
    double change = 0;
    for (std::size_t i = 0; i < total.size(); ++i) {
      if (apart_[i]) continue;
      double sum = own[i];
      for (std::size_t e = factors_.first[i]; e < factors_.first[i + 1]; ++e)
        sum += static_cast<double>(factors_.share[e]) * sent_[factors_.to[e]];
      // Only the part of a change that a face does not keep goes on to others.
      change = std::max(change, (1 - kept_[i]) * std::abs(sum - total[i]));
      total[i] = sum;
      sent_[i] = emitted[i] + (1 - kept_[i]) * sum;
    }
    if (change < tolerance_w_m2) return;
  }
}

}  // namespace irsig
