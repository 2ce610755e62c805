#include "core/sources/source_geometry.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "core/base/constants.h"
#include "core/environment/land_air.h"

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

Land::Land(std::shared_ptr<const LandScene> scene, double surface_z_m, Vec<Body> centre,
           std::vector<double> behind_range_m)
    : scene_(std::move(scene)),
      surface_z_m_(surface_z_m),
      cos_heading_(std::cos(scene_->heading_deg * kRadPerDeg)),
      sin_heading_(std::sin(scene_->heading_deg * kRadPerDeg)),
      centre_(centre),
      behind_range_m_(std::move(behind_range_m)) {}

Vec<Enu> Land::place(Vec<Body> p) const {
  const Vec<Enu> level = direction({p.x + centre_.x, p.y + centre_.y, 0});
  return {level.x, level.y, scene_->surface_m + surface_z_m_ - p.z};
}

Vec<Enu> Land::direction(Vec<Body> d) const {
  return {d.x * sin_heading_ + d.y * cos_heading_, d.x * cos_heading_ - d.y * sin_heading_, -d.z};
}

namespace {

Land::RangeShare share_of(std::span<const double> node_m, double range_m) {
  if (node_m.size() < 2) return {};
  const auto next = std::upper_bound(node_m.begin() + 1, node_m.end() - 1, range_m);
  const auto node = static_cast<std::uint32_t>(next - node_m.begin()) - 1;
  const double f = (range_m - node_m[node]) / (node_m[node + 1] - node_m[node]);
  return {node, static_cast<float>(std::clamp(f, 0.0, 1.0))};
}

}  // namespace

Land::RangeShare Land::around(double range_m) const { return share_of(kLandRangeM, range_m); }
Land::RangeShare Land::behind(double range_m) const { return share_of(behind_range_m_, range_m); }

bool hidden_by(const Plane& plane, Vec<Body> point, Vec<Body> sensor) {
  const double h = plane.z_m - point.z, radius = plane.earth_radius_m;
  if (h < 0) return true;
  if (!(radius > 0) || sensor.z <= plane.z_m) return false;
  const Vec<Body> towards = sensor - point;
  const double range_m = length(towards);
  const double up = -towards.z / range_m + plane.lift_rad;
  const double b = (point.x * towards.x + point.y * towards.y) / range_m + (radius + h) * up;
  const double c = point.x * point.x + point.y * point.y + 2 * radius * h + h * h;
  // Where the line enters the sphere; behind the sensor it may well do so.
  return b < 0 && b * b > c && c / (-b + std::sqrt(b * b - c)) < range_m;
}

bool SourceGeometry::glitters() const {
  return std::holds_alternative<Sea>(boundary) &&
         std::any_of(sun.begin(), sun.end(),
                     [](const SunDirection& s) { return s.sea_wind_m_s > 0 && s.direction.z < 0; });
}

}  // namespace irsig
