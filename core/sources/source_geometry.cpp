#include "core/sources/source_geometry.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace irsig {

std::optional<Plane> plane_of(const Boundary& boundary) {
  return std::visit(
      [](const auto& b) -> std::optional<Plane> {
        if constexpr (std::is_base_of_v<Plane, std::decay_t<decltype(b)>>)
          return Plane{b};
        else
          return std::nullopt;
      },
      boundary);
}

bool hidden_by(const Plane& plane, Vec<Body> point, Vec<Body> sensor) {
  const double h = plane.z_m - point.z, radius = plane.earth_radius_m;
  if (h < 0) return true;
  if (!(radius > 0) || sensor.z <= plane.z_m) return false;
  const Vec<Body> towards = sensor - point;
  const double range_m = length(towards);
  const double up = -towards.z / range_m + plane.lift_rad;
  const double b = (point.x * towards.x + point.y * towards.y) / range_m + (radius + h) * up;
  const double c = point.x * point.x + point.y * point.y + 2 * radius * h + h * h;
  // Distance at which the line enters the sphere; it may lie behind the sensor.
  return b < 0 && b * b > c && c / (-b + std::sqrt(b * b - c)) < range_m;
}

bool SourceGeometry::glitters() const {
  return std::holds_alternative<Sea>(boundary) &&
         std::any_of(sun.begin(), sun.end(),
                     [](const SunDirection& s) { return s.sea_wind_m_s > 0 && s.direction.z < 0; });
}

}  // namespace irsig
