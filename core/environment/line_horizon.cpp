#include "core/environment/line_horizon.h"

#include <algorithm>
#include <cmath>

#include "core/base/constants.h"

namespace irsig {

LineHorizon::LineHorizon(const GrazingRay& ray, double height_m, const SensorLine& line,
                         double lift_rad)
    : ray_(ray),
      height_m_(height_m),
      lift_rad_(lift_rad),
      elevation_rad_(line.elevation_deg * kRadPerDeg),
      sensor_up_m_(line.range_m * std::sin(elevation_rad_)),
      sensor_along_m_(line.range_m * std::cos(elevation_rad_)) {
  const double r = kEarthRadiusM + height_m;
  sensor_m_ = height_m + (line.range_m * line.range_m + 2 * r * sensor_up_m_) /
                             (std::hypot(r + sensor_up_m_, sensor_along_m_) + r);
  between_rad_ = std::atan2(sensor_along_m_, r + sensor_up_m_);
  to_touch_rad_ = ray.angle_rad(sensor_m_);
  passes_m_ = ray.height_m(between_rad_ - to_touch_rad_);
  const double fall_m = sensor_up_m_ - (passes_m_ - height_m);
  const double length_m = std::hypot(fall_m, sensor_along_m_);
  z_ = static_cast<float>(line.range_m > 0 ? fall_m / length_m : std::sin(ray.dip_rad(height_m)));
}

SeaHorizon LineHorizon::horizon() const {
  const double bottom_m = ray_.bottom_m(), surface_m = kEarthRadiusM + bottom_m;
  SeaHorizon out{static_cast<double>(z_), surface_m, 0,
                           between_rad_ > to_touch_rad_ ? passes_m_ - bottom_m : 0};
  if (ray_.straight()) return out;
  // The sphere above which straight rays go as these do: one that leaves the sensor and touches it
  // passes the target at that height; or, if the target is nearer, touches it as far away.
  const double up_m = std::max(sensor_m_ - bottom_m, 0.0);
  const double along_m = surface_m * std::max(between_rad_, to_touch_rad_);
  const double over_m = between_rad_ > to_touch_rad_ ? passes_m_ - bottom_m : 0;
  const auto too_curved = [&](double per_m) {
    const double touched = 2 * std::asin(std::sqrt(up_m * per_m / (2 + 2 * up_m * per_m)));
    const double left = along_m * per_m - touched;
    if (left <= 0) return false;
    const double s = std::sin(0.5 * left);
    return 2 * s * s / std::cos(left) > over_m * per_m;
  };
  double low = 0.1 / surface_m, high = 2 / surface_m;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (too_curved(middle) ? high : low) = middle;
  }
  const double radius_m = 1 / high, turn = surface_m * between_rad_ / radius_m;
  const double far_m = radius_m + sensor_m_ - bottom_m, chord = std::sin(0.5 * turn);
  const double rise_m = sensor_m_ - height_m_ - 2 * far_m * chord * chord;
  out.earth_radius_m = radius_m;
  out.lift_rad = std::atan2(rise_m, far_m * std::sin(turn)) - elevation_rad_;
  return out;
}

BehindSight LineHorizon::sight(const BackgroundDirections& nodes, double z, bool above) const {
  constexpr double kSteep = 0.2;  // there the height of passing does not matter, nor is it one
  const double bottom_m = ray_.bottom_m();
  const double along = std::sqrt(std::max(0.0, 1 - z * z));
  double passes_m = height_m_;
  if (along > kSteep && sensor_along_m_ > 0) {
    passes_m = std::max(bottom_m, height_m_ + sensor_up_m_ - z / along * sensor_along_m_);
  }
  const double elevation = -std::asin(std::clamp(z, -1.0, 1.0)) - lift_rad_;
  const double dip = ray_.dip_rad(passes_m);
  if (above) {
    const double limb = elevation >= 0 ? 0 : dip > 0 ? std::min(1.0, -elevation / dip) : 1;
    const double sine = std::sin(elevation);
    return {true, sine, limb, nodes.direction(-sine)};
  }
  // n r cos(elevation) is the same all along a ray.
  const double down = std::sin(std::max(0.0, -elevation)), of_dip = std::sin(dip);
  const double surface2 = std::max(0.0, (down * down - of_dip * of_dip) / (1 - of_dip * of_dip));
  const double own_dip = std::sin(ray_.dip_rad(height_m_));
  const double sine = std::sqrt(surface2 + (1 - surface2) * own_dip * own_dip);
  return {false, std::min(1.0, sine), 0, nodes.direction(std::sqrt(surface2))};
}

}  // namespace irsig
