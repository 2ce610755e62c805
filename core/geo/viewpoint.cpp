#include "core/geo/viewpoint.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/check.h"
#include "core/base/constants.h"

namespace irsig {
namespace {

double wrapped_azimuth_deg(double azimuth_deg) {
  const double rest = std::fmod(azimuth_deg, 360.0);
  const double wrapped = rest < 0.0 ? rest + 360.0 : rest;
  return wrapped < 360.0 ? wrapped : 0.0;  // -1e-20 + 360 rounds to 360
}

void check_elevation(double elevation_deg) {
  IRSIG_CHECK(elevation_deg >= -90.0);
  IRSIG_CHECK(elevation_deg <= 90.0);
}

}  // namespace

std::vector<Viewpoint> fibonacci_viewpoints(std::uint32_t count, double range_m,
                                            double elevation_min_deg, double elevation_max_deg) {
  check_elevation(elevation_min_deg);
  check_elevation(elevation_max_deg);
  IRSIG_CHECK(elevation_min_deg <= elevation_max_deg);
  // 360 deg (1 - 1 / golden ratio)
  constexpr double kGoldenAngleDeg = 360.0 * (2.0 - std::numbers::phi);
  const double sin_min = std::sin(elevation_min_deg * kRadPerDeg);
  const double sin_max = std::sin(elevation_max_deg * kRadPerDeg);
  std::vector<Viewpoint> out;
  out.reserve(count);
  for (std::uint32_t k = 0; k < count; ++k) {
    const double sin_elevation = std::lerp(sin_min, sin_max, (k + 0.5) / count);
    out.push_back({wrapped_azimuth_deg(k * kGoldenAngleDeg),
                   std::asin(std::clamp(sin_elevation, -1.0, 1.0)) / kRadPerDeg, range_m});
  }
  return out;
}

std::vector<Viewpoint> grid_viewpoints(const std::vector<double>& azimuth_deg,
                                       const std::vector<double>& elevation_deg, double range_m) {
  std::vector<Viewpoint> out;
  out.reserve(azimuth_deg.size() * elevation_deg.size());
  for (const double elevation : elevation_deg) {
    check_elevation(elevation);
    for (const double azimuth : azimuth_deg) {
      out.push_back({wrapped_azimuth_deg(azimuth), elevation, range_m});
    }
  }
  return out;
}

std::vector<Viewpoint> ring_viewpoints(std::uint32_t count,
                                       const std::vector<double>& elevation_deg, double range_m) {
  std::vector<double> azimuth_deg;
  azimuth_deg.reserve(count);
  for (std::uint32_t k = 0; k < count; ++k) azimuth_deg.push_back(360.0 * k / count);
  return grid_viewpoints(azimuth_deg, elevation_deg, range_m);
}

}  // namespace irsig
