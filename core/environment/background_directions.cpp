#include "core/environment/background_directions.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace irsig {
namespace {

// Distances from a horizon: above, where the ray's lowest point rises in proportion; below, where
// the sea is met at an angle that grows as the root.
std::vector<double> steps(double most, bool above) {
  std::vector<double> out = above ? std::vector<double>{4e-4, 1e-3, 2e-3}
                                  : std::vector<double>{2e-5,   7e-5,   1.6e-4, 3e-4,   5e-4, 8e-4,
                                                        1.2e-3, 1.8e-3, 2.6e-3, 3.6e-3, 5e-3};
  while (out.back() < most) {
    out.push_back(out.back() + std::max(0.15 * out.back(), 0.002));
  }
  return out;
}

}  // namespace

BackgroundDirections::BackgroundDirections(std::vector<float> z, double azimuth_rad)
    : z_(std::move(z)), azimuth_rad_(azimuth_rad) {
  IRSIG_CHECK(!z_.empty());
  IRSIG_CHECK(std::is_sorted(z_.begin(), z_.end()));
}

BackgroundDirections BackgroundDirections::spanning(double from_z, double to_z,
                                                    std::vector<float> breaks, double azimuth_rad) {
  const auto from = static_cast<float>(std::max(from_z, -1.0)),
             to = static_cast<float>(std::min(to_z, 1.0));
  std::sort(breaks.begin(), breaks.end());
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
  std::vector<float> z{from, to};
  const auto add = [&](double at) {
    const auto x = static_cast<float>(at);
    if (x > from && x < to) z.push_back(x);
  };
  if (!breaks.empty()) {
    for (const double d : steps(static_cast<double>(breaks.front() - from), true))
      add(static_cast<double>(breaks.front()) - d);
    for (const double d : steps(static_cast<double>(to - breaks.back()), false))
      add(static_cast<double>(breaks.back()) + d);
  }
  std::sort(z.begin(), z.end());
  z.erase(std::unique(z.begin(), z.end()), z.end());
  for (const float b : breaks) {
    if (b < from || b > to) continue;
    std::erase(z, b);
    z.insert(z.end(), 2, b);
  }
  std::sort(z.begin(), z.end());
  return BackgroundDirections(std::move(z), azimuth_rad);
}

bool BackgroundDirections::above(std::uint32_t node, float horizon_z) const {
  if (z_[node] != horizon_z) return z_[node] < horizon_z;
  return node + 1 < count() && z_[node + 1] == horizon_z;
}

Vec<Body> BackgroundDirections::direction(double z) const {
  const double c = std::sqrt(std::max(0.0, 1 - z * z));
  return {c * std::cos(azimuth_rad_), c * std::sin(azimuth_rad_), z};
}

int BackgroundDirections::shares(float z, Share* out) const {
  // A direction on the horizon itself is below it.
  const auto next = std::upper_bound(z_.begin(), z_.end(), z);
  if (next == z_.begin() || next == z_.end()) {
    out[0] = {next == z_.begin() ? 0 : count() - 1, 1.0f};
    return 1;
  }
  const auto n = static_cast<std::uint32_t>(next - z_.begin());
  const float f = (z - z_[n - 1]) / (z_[n] - z_[n - 1]);
  out[0] = {n - 1, 1 - f};
  if (f == 0) return 1;
  out[1] = {n, f};
  return 2;
}

}  // namespace irsig
