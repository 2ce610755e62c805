#include "core/environment/sea/glitter_sums.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/environment/sea/sea_surface.h"

namespace irsig {
namespace {

std::size_t step_of(double cosine) {
  return std::min(kIncidences - 1, static_cast<std::size_t>(cosine * kIncidences));
}

}  // namespace

double largest_reflectance(std::complex<double> index, std::size_t step) {
  return water_reflectance(index, static_cast<double>(step) / kIncidences);
}

// Integrates over slopes of equal probability times directions: the flatter the light leaves, the
// more there is.
Incidences mirrored_in_all(Vec<Body> to_light, double wind_m_s) {
  Incidences sum{};
  const double variance = sea_slope_variance(wind_m_s);
  constexpr int kSlopes = 80, kTurns = 64;
  for (int i = 0; i < kSlopes; ++i) {
    const double slope = std::sqrt(-variance * std::log((i + 0.5) / kSlopes));
    const double up = 1 / std::sqrt(1 + slope * slope);
    for (int j = 0; j < kTurns; ++j) {
      const double turn = 2 * std::numbers::pi * (j + 0.5) / kTurns;
      const Vec<Body> normal = {up * slope * std::cos(turn), up * slope * std::sin(turn), -up};
      const double cosine = dot(normal, to_light);
      const Vec<Body> out = 2 * cosine * normal - to_light;
      if (cosine <= 0 || out.z >= 0) continue;
      sum[step_of(cosine)] +=
          cosine / (up * sea_projected_area(-out.z, wind_m_s)) / (kSlopes * kTurns);
    }
  }
  return sum;
}

// Opposite the light, where for an elevation the facets have the least slope and the largest angle
// of incidence.
Incidences largest_mirrored(Vec<Body> to_light, double wind_m_s) {
  Incidences largest{};
  const double level = std::hypot(to_light.x, to_light.y);
  const double x = level > 0 ? to_light.x / level : 1, y = level > 0 ? to_light.y / level : 0;
  constexpr int kElevations = 1800;  // 0.05 deg; a slope's deviation is at least 3 deg
  for (int i = 0; i <= kElevations; ++i) {
    const double e = 0.5 * std::numbers::pi * i / kElevations;
    const Vec<Body> to_target = {-x * std::cos(e), -y * std::cos(e), -std::max(std::sin(e), 1e-9)};
    const double per_sr = glint_per_sr(to_target, to_light, wind_m_s);
    if (per_sr <= 0) continue;
    double& to = largest[step_of(dot(normalized(to_target + to_light), to_light))];
    to = std::max(to, per_sr);
  }
  return largest;
}

}  // namespace irsig
