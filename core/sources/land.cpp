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
           std::vector<double> behind_range_m, double bend_per_m)
    : scene_(std::move(scene)),
      surface_z_m_(surface_z_m),
      cos_heading_(std::cos(scene_->heading_deg * kRadPerDeg)),
      sin_heading_(std::sin(scene_->heading_deg * kRadPerDeg)),
      centre_(centre),
      behind_range_m_(std::move(behind_range_m)),
      bend_per_m_(bend_per_m) {}

// In the frame of straight lines the Earth is a parabola c r^2 below its tangent plane at the
// target. The line that touches it at r0 passes the target at c r0^2 and the sensor, at a distance
// d on its other side, at c (d + r0)^2 above the parabola; for one that touches it before the
// target r0 is negative. The sphere lies r^4 / (8 R^3) below its parabola.
double Land::bend_of(const Environment::Horizon& horizon, double sensor_m, double along_m) {
  constexpr double kR = kEarthRadiusM;
  if (!std::isfinite(horizon.z)) return 0;  // of a sensor straight above the target
  const double z = std::clamp(horizon.z, -1.0, 1.0), along = std::sqrt(1 - z * z);
  double touch2_m2 = 0, curve_per_m = 0.5 / kR;
  for (int pass = 0; pass < 3; ++pass) {
    const double beyond_per_m = touch2_m2 / (8 * kR * kR * kR);
    const double above_m = sensor_m + along_m * along_m * (0.5 / kR + beyond_per_m);
    if (!(above_m > 0) || !(along > 0)) return 0;
    const double falls = z / along, passes_m = std::max(0.0, sensor_m - along_m * falls);
    const double root = horizon.hides_m > 0 ? (std::sqrt(above_m) + std::sqrt(passes_m)) / along_m
                                            : (falls + along_m * (0.5 / kR + beyond_per_m)) /
                                                  (std::sqrt(above_m) + std::sqrt(passes_m));
    curve_per_m = root * root - beyond_per_m;
    touch2_m2 = passes_m / (root * root);
  }
  return 0.5 / kR - curve_per_m;
}

Vec<Enu> Land::place(Vec<Body> p) const {
  const Vec<Enu> level = direction({p.x + centre_.x, p.y + centre_.y, 0});
  return {level.x, level.y, scene_->surface_m + surface_z_m_ - p.z};
}

Vec<Enu> Land::direction(Vec<Body> d) const {
  return {d.x * sin_heading_ + d.y * cos_heading_, d.x * cos_heading_ - d.y * sin_heading_, -d.z};
}

Vec<Enu> Land::lift(Vec<Body> sensor) const {
  const Vec<Enu> at = place(sensor);
  return {bend_per_m_ * at.x, bend_per_m_ * at.y, 0};
}

void Land::set_kinds(const LandPoint& at, bool object, LandMix& mix) const {
  mix.kind.clear();
  if (scene_->kinds)
    return scene_->kinds->at(at.departure_m.x, at.departure_m.y, at.normal, object, mix.fraction,
                             mix.kind);
  for (std::uint32_t m = 0; m < mix.fraction.size(); ++m)
    if (mix.fraction[m] > 0) mix.kind.push_back({m, mix.fraction[m]});
}

std::optional<LandPoint> Land::meet(Vec<Enu> origin, Vec<Enu> towards, LandMix& mix) const {
  mix.fraction.resize(materials());
  const std::optional<LandHit> hit = field().first_hit(origin, towards, kFarM, bend_per_m_);
  if (const LandObjects* objects = scene_->objects.get())
    if (const auto met =
            objects->first_hit(origin, towards, hit ? hit->distance : kFarM, bend_per_m_)) {
      std::fill(mix.fraction.begin(), mix.fraction.end(), 0.0f);
      mix.fraction[met->material] = 1;
      const LandPoint out{met->distance, met->normal, met->departure_m};
      set_kinds(out, true, mix);
      return out;
    }
  if (!hit || hit->at_edge) return std::nullopt;
  LandPoint out{hit->distance, hit->normal, field().departure_m(origin, towards, *hit)};
  out.departure_m.z += raised_m(out.departure_m);
  scene_->cover.at(out.departure_m.x, out.departure_m.y, mix.fraction);
  set_kinds(out, false, mix);
  return out;
}

std::optional<LandPoint> Land::meet(Vec<Body> from, Vec<Body> along, LandMix& mix) const {
  return meet(place(from), direction(along), mix);
}

std::optional<LandPoint> Land::meet_in_sight(Vec<Body> sensor, Vec<Body> from, Vec<Body> along,
                                             LandMix& mix) const {
  Vec<Enu> origin = place(from), towards = direction(along);
  const Vec<Enu> higher = lift(sensor);
  origin.z += dot(higher, origin);
  towards.z += dot(higher, towards);
  return meet(origin, towards, mix);
}

bool Land::hides(Vec<Body> from, Vec<Body> along, double most) const {
  return hidden(place(from), direction(along), most);
}

bool Land::hidden(Vec<Enu> origin, Vec<Enu> towards, double most) const {
  return field().hidden(origin, towards, most, bend_per_m_) ||
         (scene_->objects != nullptr &&
          scene_->objects->hidden(origin, towards, most, bend_per_m_));
}

double Land::highest_m(double west_m, double east_m, double south_m, double north_m) const {
  const double land_m = field().highest_m(west_m, east_m, south_m, north_m);
  return scene_->objects == nullptr
             ? land_m
             : std::max(land_m, scene_->objects->highest_m(west_m, east_m, south_m, north_m));
}

bool Land::hides_from(Vec<Body> sensor, Vec<Body> from, double most) const {
  const Vec<Enu> origin = place(from);
  Vec<Enu> towards = direction(sensor - from);
  towards.z += dot(lift(sensor), towards);
  return hidden(origin, towards, most);
}

double Land::clear_in_sight_m(Vec<Body> sensor, Vec<Body> along, double radius_m,
                              double spread) const {
  const Vec<Enu> higher = lift(sensor);
  return clear_beyond_m(along, radius_m, spread + std::hypot(higher.x, higher.y));
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
    const double around_m = radius_m + spread * far_m,
                 raised_m = std::max(0.0, bend_per_m_) * (far_m + around_m) * (far_m + around_m),
                 lowest_m = std::min(a.z, b.z) - around_m - raised_m;
    if (towards.z > spread + std::max(0.0, bend_per_m_) * 4 * across_m && lowest_m > top_m) break;
    if (highest_m(std::min(a.x, b.x) - around_m, std::max(a.x, b.x) + around_m,
                  std::min(a.y, b.y) - around_m, std::max(a.y, b.y) + around_m) > lowest_m)
      out = far_m + radius_m;
  }
  return out;
}

double Land::leaves_map_m(Vec<Body> from, Vec<Body> along) const {
  const Vec<Enu> origin = place(from), towards = direction(along);
  const HeightGrid& map = field().outer();
  double enters = 0, leaves = kFarM;
  const auto clip = [&](double at, double step, double least, double most) {
    if (step == 0) {
      if (at < least || at > most) leaves = -1;
      return;
    }
    const double a = (least - at) / step, b = (most - at) / step;
    enters = std::max(enters, std::min(a, b));
    leaves = std::min(leaves, std::max(a, b));
  };
  clip(origin.x, towards.x, map.west_m, map.west_m + map.columns * map.spacing_m);
  clip(origin.y, towards.y, map.south_m, map.south_m + map.rows * map.spacing_m);
  return leaves > enters ? leaves : 0;
}

// `window`: half of its sides, as a tangent; `higher`: lift(). The wall is a line of sight's
// upright segment, of which some points are asked. Lines from the raised sensor are straight over
// raised land; what counts in the window is the direction that they had without the bend.
bool Land::sees(const EdgeStep& step, Vec<Enu> sensor, Vec<Enu> higher, double window) const {
  constexpr double kAboveM = 0.01;  // the edge, where the wall faces away
  constexpr int kPoints = 5;
  const Vec<Enu> forward = normalized(place({0, 0, 0}) - sensor);
  const double along = std::hypot(forward.x, forward.y);
  const Vec<Enu> right =
      along > 1e-6 ? Vec<Enu>{forward.y / along, -forward.x / along, 0} : Vec<Enu>{1, 0, 0};
  const Vec<Enu> up = cross(right, forward);
  const Vec<Enu> raised_sensor{sensor.x, sensor.y, sensor.z + dot(higher, sensor)};
  const auto [low_m, high_m] = std::minmax(step.land_z_m, step.ground_z_m);
  for (int i = 0; i <= kPoints; ++i) {
    Vec<Enu> at{step.x_m, step.y_m,
                high_m + kAboveM - (high_m - low_m) * i / static_cast<double>(kPoints)};
    at.z += raised_m(at);
    const Vec<Enu> to_sensor = raised_sensor - at;
    Vec<Enu> seen = -1.0 * to_sensor;
    seen.z -= dot(higher, seen);
    const double most_m = window * dot(seen, forward);  // negative behind the sensor
    if (std::abs(dot(seen, up)) <= most_m &&
        std::abs(dot(seen, right)) <= most_m + field().outer().spacing_m &&
        !hidden(at, to_sensor, 1))
      return true;
  }
  return false;
}

std::optional<EdgeStep> Land::step_in_sight(Vec<Body> sensor, double half_m) const {
  const Vec<Enu> from = place(sensor), higher = lift(sensor);
  const double window = half_m / length(sensor);
  const auto height_m = [](const EdgeStep& s) { return std::abs(s.land_z_m - s.ground_z_m); };
  std::optional<EdgeStep> out;
  for (const EdgeStep& step : scene_->edge_step)
    if ((!out || height_m(step) > height_m(*out)) && sees(step, from, higher, window)) out = step;
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

bool Land::covers_in_sight(Vec<Body> sensor, Vec<Body> point) const {
  Vec<Enu> at = place(point);
  at.z += dot(lift(sensor), at) - raised_m(at);
  const std::optional<double> surface_m = field().z_m(at.x, at.y);
  return (surface_m && at.z < *surface_m) ||
         (scene_->objects != nullptr && scene_->objects->around(at).has_value());
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
