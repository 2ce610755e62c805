#include "core/land/kinds/land_below_target.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace irsig {
namespace {

// Fraction of a wall's view of the level ground that lies within u of its height.
double wall_view_within(double u) {
  return 2 / std::numbers::pi * (std::atan(u) - u / (1 + u * u));
}

// The distance in heights within which a wall sees a fraction of the ground.
double wall_view_distance(double fraction) {
  double low = 0, high = 1e3;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (wall_view_within(middle) < fraction ? low : high) = middle;
  }
  return low;
}

}  // namespace

std::vector<KindShare> land_below_target(const LandScene& land, const LandKinds& kinds,
                                         const TargetOnLand& target) {
  constexpr int kDistances = 24, kAzimuths = 32;
  std::vector<float> fraction(land.cover.materials());
  std::vector<double> weight(kinds.kind.size(), 0.0);
  std::vector<KindShare> mix;
  double all = 0;
  for (int d = 0; d < kDistances; ++d) {
    const double away_m =
        target.half_m + target.above_m * wall_view_distance((d + 0.5) / kDistances);
    for (int a = 0; a < kAzimuths; ++a) {
      const double azimuth = 2 * std::numbers::pi * (a + 0.5) / kAzimuths,
                   x_m = target.x_m + away_m * std::sin(azimuth),
                   y_m = target.y_m + away_m * std::cos(azimuth);
      if (!land.field->z_m(x_m, y_m)) continue;  // beyond the map
      land.cover.at(x_m, y_m, fraction);
      mix.clear();
      kinds.at(x_m, y_m, {0, 0, 1}, false, fraction, mix);
      for (const KindShare& part : mix) {
        weight[part.kind] += static_cast<double>(part.share);
        all += static_cast<double>(part.share);
      }
    }
  }
  std::vector<KindShare> out;
  for (std::size_t k = 0; k < weight.size(); ++k)
    if (weight[k] > 0)
      out.push_back({static_cast<std::uint32_t>(k), static_cast<float>(weight[k] / all)});
  return out;
}

}  // namespace irsig
