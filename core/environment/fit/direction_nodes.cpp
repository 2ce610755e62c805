#include "core/environment/fit/direction_nodes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/check.h"

namespace irsig {

DirectionNodes::DirectionNodes(std::vector<float> sky_sin, std::vector<float> lower_sin,
                               std::uint32_t azimuths, double first_azimuth_rad)
    : sky_sin_(std::move(sky_sin)),
      lower_sin_(std::move(lower_sin)),
      azimuths_(azimuths),
      first_azimuth_rad_(first_azimuth_rad) {
  IRSIG_CHECK(!sky_sin_.empty());
  IRSIG_CHECK(!lower_sin_.empty());
  IRSIG_CHECK(azimuths_ > 0);
  IRSIG_CHECK(std::is_sorted(sky_sin_.begin(), sky_sin_.end()));
  IRSIG_CHECK(std::is_sorted(lower_sin_.begin(), lower_sin_.end()));
  sky_ = static_cast<std::uint32_t>(sky_sin_.size()) * azimuths_;
  lower_ = static_cast<std::uint32_t>(lower_sin_.size()) * azimuths_;
}

int DirectionNodes::shares(float x, float y, float z, Share* out) const {
  const bool above = z < 0;
  const std::vector<float>& ring = above ? sky_sin_ : lower_sin_;
  const std::uint32_t first = above ? 0 : sky_;
  const float s = std::abs(z);
  // The ring at or below, and how far the direction is towards the next.
  const auto next = std::upper_bound(ring.begin(), ring.end(), s);
  std::uint32_t r = 0;
  float up = 0;
  if (next == ring.end()) {
    r = static_cast<std::uint32_t>(ring.size()) - 1;
  } else if (next != ring.begin()) {
    r = static_cast<std::uint32_t>(next - ring.begin()) - 1;
    up = (s - ring[r]) / (ring[r + 1] - ring[r]);
  }
  std::uint32_t a = 0, b = 0;
  float turn = 0;
  if (azimuths_ > 1) {
    constexpr float kInverseTurn = static_cast<float>(0.5 * std::numbers::inv_pi);
    float at = (std::atan2(y, x) - static_cast<float>(first_azimuth_rad_)) * kInverseTurn;
    at = (at - std::floor(at)) * static_cast<float>(azimuths_);
    a = std::min(static_cast<std::uint32_t>(at), azimuths_ - 1);
    b = a + 1 == azimuths_ ? 0 : a + 1;
    turn = std::min(at - static_cast<float>(a), 1.0f);
  }
  int n = 0;
  for (std::uint32_t k = 0; k < 2; ++k) {
    const float of_ring = k == 0 ? 1 - up : up;
    if (of_ring == 0) continue;
    const std::uint32_t start = first + (r + k) * azimuths_;
    if (turn < 1) out[n++] = {start + a, of_ring * (1 - turn)};
    if (turn > 0) out[n++] = {start + b, of_ring * turn};
  }
  return n;
}

double DirectionNodes::sin_elevation(std::uint32_t node) const {
  return node < sky_ ? static_cast<double>(sky_sin_[node / azimuths_])
                     : -static_cast<double>(lower_sin_[(node - sky_) / azimuths_]);
}

Vec<Body> DirectionNodes::direction(std::uint32_t node) const {
  const double s = sin_elevation(node), c = std::sqrt(std::max(0.0, 1 - s * s));
  const std::uint32_t turn = (node < sky_ ? node : node - sky_) % azimuths_;
  const double azimuth = first_azimuth_rad_ + 2 * std::numbers::pi * turn / azimuths_;
  return {c * std::cos(azimuth), c * std::sin(azimuth), -s};
}

}  // namespace irsig
