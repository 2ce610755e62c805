#include "core/environment/fit/ring_ratios.h"

#include <algorithm>
#include <utility>

namespace irsig {

Stencil cubic(const std::vector<double>& at, double x) {
  Stencil s;
  s.count = std::min<std::size_t>(4, at.size());
  std::size_t above =
      static_cast<std::size_t>(std::upper_bound(at.begin(), at.end(), x) - at.begin());
  above = std::clamp<std::size_t>(above, 2, std::max<std::size_t>(2, at.size()));
  s.first = std::min(above - 2, at.size() - s.count);
  for (std::size_t i = 0; i < s.count; ++i) {
    double w = 1;
    for (std::size_t j = 0; j < s.count; ++j) {
      if (j != i) w *= (x - at[s.first + j]) / (at[s.first + i] - at[s.first + j]);
    }
    s.weight[i] = w;
  }
  return s;
}

std::vector<std::size_t> RingRatios::exact_rings(std::size_t rings) {
  constexpr std::size_t kExact = 8;
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < kExact; ++i) {
    const std::size_t r = (i * (rings - 1) + (kExact - 1) / 2) / (kExact - 1);
    if (out.empty() || r > out.back()) out.push_back(r);
  }
  return out;
}

RingRatios::RingRatios(std::size_t rings, Exact exact)
    : rings_(rings),
      compute_(std::move(exact)),
      exact_ring_(exact_rings(rings)),
      known_(exact_ring_.size()) {}

const AirSpectrum& RingRatios::exact(std::size_t which) {
  if (!known_[which]) known_[which] = compute_(exact_ring_[which]);
  return *known_[which];
}

AirSpectrum RingRatios::at(std::size_t ring) {
  const Stencil s = cubic({exact_ring_.begin(), exact_ring_.end()}, static_cast<double>(ring));
  AirSpectrum out(kAirBandCount, 0.0);
  for (std::size_t i = 0; i < s.count; ++i) {
    if (s.weight[i] == 0) continue;
    const AirSpectrum& ratio = exact(s.first + i);
    for (std::size_t b = 0; b < kAirBandCount; ++b) out[b] += s.weight[i] * ratio[b];
  }
  for (double& x : out) x = std::max(0.0, x);
  return out;
}

std::array<std::size_t, 3> RingRatios::coarse_rings() const {
  const std::size_t last = exact_ring_.size() - 1;
  return {exact_ring_[0], exact_ring_[last / 2], exact_ring_[last]};
}

AirSpectrum RingRatios::coarse(std::size_t ring) {
  const std::size_t last = exact_ring_.size() - 1, middle = last / 2;
  const std::size_t low = ring < exact_ring_[middle] ? 0 : middle;
  const std::size_t high = low == 0 ? middle : last;
  const AirSpectrum &a = exact(low), &b = exact(high);
  const double f = static_cast<double>(ring - exact_ring_[low]) /
                   static_cast<double>(exact_ring_[high] - exact_ring_[low]);
  AirSpectrum out(kAirBandCount);
  for (std::size_t k = 0; k < kAirBandCount; ++k) out[k] = (1 - f) * a[k] + f * b[k];
  return out;
}

}  // namespace irsig
