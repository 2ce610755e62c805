#include "core/sources/land.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/constants.h"
#include "core/environment/land_air.h"

namespace irsig {
namespace {

constexpr double kFarM = 1e9;

Land::RangeShare share_of(std::span<const double> node_m, double range_m) {
  if (node_m.size() < 2) return {};
  const auto next = std::upper_bound(node_m.begin() + 1, node_m.end() - 1, range_m);
  const auto node = static_cast<std::uint32_t>(next - node_m.begin()) - 1;
  const double f = (range_m - node_m[node]) / (node_m[node + 1] - node_m[node]);
  return {node, static_cast<float>(std::clamp(f, 0.0, 1.0))};
}

}  // namespace

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

std::optional<LandPoint> Land::meet(Vec<Body> from, Vec<Body> along,
                                    std::span<float> fraction) const {
  const Vec<Enu> origin = place(from), towards = direction(along);
  const std::optional<LandHit> hit = field().first_hit(origin, towards, kFarM);
  if (const LandObjects* objects = scene_->objects.get())
    if (const auto met = objects->first_hit(origin, towards, hit ? hit->distance : kFarM)) {
      std::fill(fraction.begin(), fraction.end(), 0.0f);
      fraction[met->material] = 1;
      return LandPoint{met->distance, met->normal, met->departure_m};
    }
  if (!hit || hit->at_edge) return std::nullopt;
  const LandPoint out{hit->distance, hit->normal, field().departure_m(origin, towards, *hit)};
  scene_->cover.at(out.departure_m.x, out.departure_m.y, fraction);
  return out;
}

bool Land::hides(Vec<Body> from, Vec<Body> along, double most) const {
  return hidden(place(from), direction(along), most);
}

bool Land::hidden(Vec<Enu> origin, Vec<Enu> towards, double most) const {
  return field().hidden(origin, towards, most) ||
         (scene_->objects != nullptr && scene_->objects->hidden(origin, towards, most));
}

double Land::highest_m(double west_m, double east_m, double south_m, double north_m) const {
  const double land_m = field().highest_m(west_m, east_m, south_m, north_m);
  return scene_->objects == nullptr
             ? land_m
             : std::max(land_m, scene_->objects->highest_m(west_m, east_m, south_m, north_m));
}

double Land::clear_beyond_m(Vec<Body> along, double radius_m, double spread) const {
  const Vec<Enu> from = place({0, 0, 0}), towards = direction(along);
  const HeightGrid& map = field().outer();
  const double east_m = map.west_m + map.columns * map.spacing_m,
               north_m = map.south_m + map.rows * map.spacing_m,
               across_m = std::hypot(east_m - map.west_m, north_m - map.south_m),
               top_m = highest_m(map.west_m, east_m, map.south_m, north_m);
  double out = 0;
  for (double near_m = 0, far_m = radius_m; near_m < 2 * across_m;
       near_m = far_m, far_m = 1.25 * far_m + radius_m) {
    const Vec<Enu> a = from + near_m * towards, b = from + far_m * towards;
    const double around_m = radius_m + spread * far_m, lowest_m = std::min(a.z, b.z) - around_m;
    if (towards.z > spread && lowest_m > top_m) break;
    if (highest_m(std::min(a.x, b.x) - around_m, std::max(a.x, b.x) + around_m,
                  std::min(a.y, b.y) - around_m, std::max(a.y, b.y) + around_m) > lowest_m)
      out = far_m + radius_m;
  }
  return out;
}

bool Land::covers(Vec<Body> point) const {
  const Vec<Enu> at = place(point);
  const std::optional<double> surface_m = field().z_m(at.x, at.y);
  return (surface_m && at.z < *surface_m) ||
         (scene_->objects != nullptr && scene_->objects->around(at).has_value());
}

std::optional<ObjectName> Land::object_around(Vec<Body> point) const {
  return scene_->objects == nullptr ? std::nullopt : scene_->objects->around(place(point));
}

double Land::sun_cosine(const LandPoint& at, Vec<Body> towards_sun) const {
  const Vec<Enu> towards = direction(towards_sun);
  const double cosine = dot(at.normal, towards);
  return cosine > 0 && !hidden(at.departure_m, towards, kFarM) ? cosine : 0;
}

float Land::sky_fraction(const LandPoint& at) {
  return static_cast<float>(std::min(1.0, 0.5 * (1 + at.normal.z)));
}

Land::RangeShare Land::around(double range_m) { return share_of(kLandRangeM, range_m); }
Land::RangeShare Land::behind(double range_m) const { return share_of(behind_range_m_, range_m); }

}  // namespace irsig
