#include "core/signature/view/prepared_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/environment/line_horizon.h"
#include "core/plume/plume_silhouette.h"
#include "core/signature/view/seen_places.h"
#include "core/spectral/planck.h"
#include "core/spectral/solar.h"

namespace irsig {
namespace {

// Lines of sight are rounded.
constexpr double kGrazing = 1e-4;

// Returns the effects of surroundings without an atmosphere on a view: uniform sky and lower
// hemisphere, homogeneous air or none.
ViewEnvironment plain_environment(const ConditionSpec& condition, const Air& air, double range_m,
                                  std::span<const Environment::Line::End> ends,
                                  std::span<const double> land_range_m, bool sun,
                                  const std::vector<double>& node_um) {
  const std::size_t n = node_um.size();
  AirPath path = air_path(air, condition.air_temperature_k, range_m, node_um);
  ViewEnvironment out;
  for (const Environment::Line::End& end : ends) {
    const AirPath& there =
        out.end.emplace_back(air_path(air, condition.air_temperature_k, end.range_m, node_um));
    IncidentRadiance::AirChange& change = out.end_change.emplace_back();
    change.path_solar.assign(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      change.transmittance.push_back(there.transmittance[i] - path.transmittance[i]);
      change.path_thermal.push_back(there.path_radiance_w_m2_sr_um[i] -
                                    path.path_radiance_w_m2_sr_um[i]);
    }
  }
  out.sun.assign(n, 0.0);
  std::vector<double> sky(n), lower(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (sun) out.sun[i] = condition.sun_scale * solar_irradiance_w_m2_um(node_um[i]);
    sky[i] = sky_radiance_w_m2_sr_um(condition.surroundings, node_um[i]);
    lower[i] = lower_radiance_w_m2_sr_um(condition.surroundings, node_um[i], out.sun[i],
                                         condition.sun_cos_zenith);
  }
  const auto background_air = [&](const std::vector<double>& radiance) {
    std::vector<double> seen(n);
    for (std::size_t i = 0; i < n; ++i) seen[i] = radiance[i] * path.transmittance[i];
    return seen;
  };
  out.sun_apparent = background_air(out.sun);
  out.background_apparent = {background_air(sky), background_air(lower)};
  out.around = IncidentRadiance::of_spectra({sky, lower}, out.background_apparent);
  // Around the target the air is clear.
  const std::vector<double> clear(n, 1.0), dark(n, 0.0);
  if (!condition.land_temperature_k.empty()) {
    out.land.at_target.assign(kLandRangeM.size(), {clear, dark, sky, out.sun});
    out.land.apparent.assign(
        kLandRangeM.size(),
        {path.transmittance, dark, out.background_apparent.front(), out.sun_apparent});
  }
  for (const double land_m : land_range_m) {
    AirPath seen = air_path(air, condition.air_temperature_k, land_m, node_um);
    LandAir& behind = out.land.behind.emplace_back();
    for (std::size_t i = 0; i < n; ++i) {
      behind.path_radiance.push_back(seen.path_radiance_w_m2_sr_um[i] -
                                     path.path_radiance_w_m2_sr_um[i]);
      behind.sky.push_back(seen.transmittance[i] * sky[i]);
      behind.sun.push_back(seen.transmittance[i] * out.sun[i]);
    }
    behind.transmittance = std::move(seen.transmittance);
  }
  out.transmittance = std::move(path.transmittance);
  out.path_radiance = std::move(path.path_radiance_w_m2_sr_um);
  return out;
}

// Returns the largest distance of hot gas from the target's reference point under any condition.
double gas_reach_m(const ViewRequest& request) {
  double out = 0;
  for (const ConditionSpec& c : request.condition)
    if (c.gas != nullptr)
      for (const Vec<Body>& corner : gas_corners(*c.gas)) out = std::max(out, length(corner));
  return out;
}

}  // namespace

double land_bend_per_m(const Environment* environment, const Viewpoint& v, double above_m) {
  if (environment == nullptr) return 0;
  const double elevation = v.aspect_elevation_deg * kRadPerDeg;
  return Land::bend_of(environment->horizon(environment->line(v)),
                       above_m + v.range_m * std::sin(elevation), v.range_m * std::cos(elevation));
}

Land land_of(const ViewRequest& request, const Target& target, double range_m) {
  Viewpoint v = request.viewpoint;
  v.range_m = range_m;
  const double above_m = request.condition.front().above_surface_m;
  return {request.land,
          above_m - target.centre.z,
          target.centre,
          {},
          land_bend_per_m(request.environment.get(), v, above_m)};
}

namespace {

// Returns the first hit's distance of each ray; infinity: it meets no land of the map.
std::vector<double> distances_m(const Land& land, Vec<Body> sensor,
                                std::span<const Vec<Body>> direction) {
  LandMix mix;
  std::vector<double> out;
  for (const Vec<Body>& d : direction) {
    const auto hit = land.meet_in_sight(sensor, sensor, d, mix);
    out.push_back(hit ? hit->distance : INFINITY);
  }
  return out;
}

// Returns nodes of a range for land at these distances.
//   farthest_m  of land that rays between may meet; 0: there are none
std::vector<double> range_nodes_m(std::span<const double> distance_m, double nearest_m,
                                  double farthest_m) {
  constexpr double kStep = 1.25;  // of nodes
  constexpr int kMostNodes = 12;
  double least_m = INFINITY, most_m = farthest_m;
  for (const double d : distance_m) {
    if (std::isinf(d)) continue;
    least_m = std::min(least_m, d);
    most_m = std::max(most_m, d);
  }
  if (!(most_m > 0)) return {};
  least_m = std::isinf(least_m) ? nearest_m : std::max(0.998 * least_m, nearest_m);
  most_m = std::max(1.002 * most_m, 1.001 * least_m);
  const int steps = std::clamp(
      static_cast<int>(std::ceil(std::log(most_m / least_m) / std::log(kStep))), 2, kMostNodes - 1);
  std::vector<double> out;
  for (int i = 0; i <= steps; ++i)
    out.push_back(least_m * std::pow(most_m / least_m, static_cast<double>(i) / steps));
  return out;
}

}  // namespace

std::vector<double> land_ranges_m(std::span<const double> distance_m) {
  return range_nodes_m(distance_m, 1, 0);
}

namespace {

// Ranges of land behind a target: that in front of it is not behind it.
std::vector<double> land_ranges_behind_m(const Land& land, const Target& target, Vec<Body> sensor) {
  constexpr int kRays = 25;  // along each side of a square around the target
  // Of distances of rays side by side: where they differ by more, rays between meet land beyond.
  constexpr double kJump = 1.25;
  const Vec<Body> forward = normalized(-1.0 * sensor);
  const Vec<Body> right = std::hypot(forward.x, forward.y) > 1e-6
                              ? normalized(Vec<Body>{-forward.y, forward.x, 0})
                              : Vec<Body>{0, 1, 0};
  const Vec<Body> up = cross(right, forward);
  std::vector<Vec<Body>> direction;
  for (int i = 0; i < kRays; ++i)
    for (int k = 0; k < kRays; ++k)
      direction.push_back(normalized((2.0 * i / (kRays - 1) - 1) * target.radius_m * right +
                                     (2.0 * k / (kRays - 1) - 1) * target.radius_m * up - sensor));
  const std::vector<double> distance_m = distances_m(land, sensor, direction);
  const double range_m = length(sensor), radius_m = target.radius_m;
  bool jumps =
      std::all_of(distance_m.begin(), distance_m.end(), [](double d) { return std::isinf(d); }) &&
      land.clear_in_sight_m(sensor, forward, radius_m, radius_m / range_m) > 0;
  for (int i = 0; i < kRays; ++i)
    for (int k = 0; k < kRays; ++k)
      for (const int beside : {i > 0 ? (i - 1) * kRays + k : -1, k > 0 ? i * kRays + k - 1 : -1}) {
        if (beside < 0) continue;
        const auto [near_m, far_m] = std::minmax(distance_m[i * kRays + k], distance_m[beside]);
        jumps |= near_m < INFINITY && far_m > kJump * near_m;
      }
  double farthest_m = 0;
  if (jumps)
    for (const Vec<Body>& d : direction)
      farthest_m = std::max(farthest_m, land.leaves_map_m(sensor, d));
  return range_nodes_m(distance_m, range_m - radius_m, farthest_m);
}

}  // namespace

SourceRequest source_request(const PreparedScene& scene, const ViewRequest& request,
                             std::span<const std::uint32_t> wanted) {
  return {.condition = request.condition,
          .wanted = wanted,
          .parts = scene.target.part.size(),
          .surface_z_m = scene.surface_z_m(),
          .emitters = request.emitters,
          .land = request.land,
          .land_emissivity = scene.land_emissivity,
          .centre = scene.target.centre};
}

ViewPlan plan_with_everything(const ViewRequest& request) {
  ViewPlan plan;
  plan.effects = EffectSet::everything(request.condition.size(), request.max_reflections);
  return plan;
}

ViewSurroundings::ViewSurroundings(const ViewRequest& request, double range_m,
                                   const std::vector<double>& node_um)
    : request_(&request),
      range_m_(range_m),
      node_um_(&node_um),
      plain_bounds_(request.condition.size()),
      land_bounds_(request.condition.size()) {}

absl::StatusOr<ViewSurroundings> ViewSurroundings::make(const ViewRequest& request,
                                                        const Target& target, double range_m,
                                                        const std::vector<double>& node_um,
                                                        const BackgroundDirections* behind,
                                                        const std::vector<double>* land_range_m) {
  ViewSurroundings out(request, range_m, node_um);
  Viewpoint v = request.viewpoint;
  v.range_m = range_m;
  const Vec<Body> towards = body_from_aspect(v.aspect_azimuth_deg, v.aspect_elevation_deg);
  const auto ends = target_ends(target, range_m * towards);
  out.end_.assign(ends.begin(), ends.end());
  if (request.land != nullptr) {
    out.land_bend_per_m_ =
        land_bend_per_m(request.environment.get(), v, request.condition.front().above_surface_m);
    out.land_range_m_ = land_range_m != nullptr
                            ? *land_range_m
                            : land_ranges_behind_m(land_of(request, target, range_m), target,
                                                   range_m * towards - target.centre);
  }
  if (request.environment == nullptr) {
    if (!plane_of(boundary_of(request.condition.front(), 0))) return out;
    const GrazingRay straight;
    double lowest_m = INFINITY;
    for (const ConditionSpec& c : request.condition)
      lowest_m = std::min(lowest_m, c.above_surface_m);
    const LineHorizon horizon(straight, lowest_m, {range_m, v.aspect_elevation_deg, towards, {}},
                              0);
    out.horizon_ = horizon.horizon();
    out.behind_ = BackgroundDirections({horizon.z(), horizon.z()});
    return out;
  }
  Environment::Line line = request.environment->line(v);
  // Lines of sight leave the target downwards where the sensor is above it: between the elevations
  // of the target's lowest and highest point, as the sensor sees them.
  const double elevation = v.aspect_elevation_deg * std::numbers::pi / 180,
               reach = std::asin(std::min(1.0, std::max(length(target.centre) + target.radius_m,
                                                        gas_reach_m(request)) /
                                                   range_m)) +
                       kGrazing,
               quarter = std::numbers::pi / 2;
  line.end = out.end_;
  line.behind = behind != nullptr ? *behind
                                  : BackgroundDirections::spanning(
                                        std::sin(std::max(elevation - reach, -quarter)),
                                        std::sin(std::min(elevation + reach, quarter)),
                                        request.environment->horizons_z(line),
                                        std::atan2(-towards.y, -towards.x));
  line.land = request.land != nullptr;
  line.land_range_m = out.land_range_m_;
  out.behind_ = line.behind;
  out.horizon_ = request.environment->horizon(line);
  ASSIGN_OR_RETURN(auto look, request.environment->sight_line(line));
  out.look_.emplace(std::move(look));
  return out;
}

// Land is as warm as its warmest material, and reflects all sunlight at most.
const LightBounds& ViewSurroundings::land_bounds(std::uint32_t condition) {
  std::optional<LightBounds>& known = land_bounds_[condition];
  if (known) return *known;
  LightBounds& b = known.emplace(surrounding_bounds(condition));
  const std::vector<double>& kelvin = request_->condition[condition].land_temperature_k;
  const double warmest_k = *std::max_element(kelvin.begin(), kelvin.end());
  for (std::size_t i = 0; i < b.thermal.size(); ++i) {
    b.thermal[i] = std::max(b.thermal[i], planck_radiance_w_m2_sr_um((*node_um_)[i], warmest_k));
    const double reflected = b.sun[i] / std::numbers::pi;
    b.diffuse_sun[i] += reflected;
    b.diffuse_sun_w_m2_um[i] += b.sun[i];
    b.background_sun[i] += reflected;
  }
  return b;
}

const LightBounds& ViewSurroundings::bounds(std::uint32_t condition) {
  if (request_->land != nullptr) return land_bounds(condition);
  return surrounding_bounds(condition);
}

std::optional<CloudBounds> ViewSurroundings::cloud_bounds(std::uint32_t condition) {
  if (!look_ || request_->land != nullptr || request_->image ||
      request_->condition[condition].gas != nullptr)
    return std::nullopt;
  return look_->cloud_bounds(condition);
}

const LightBounds& ViewSurroundings::surrounding_bounds(std::uint32_t condition) {
  if (look_) return look_->bounds(condition);
  std::optional<LightBounds>& known = plain_bounds_[condition];
  if (known) return *known;
  const ConditionSpec& c = request_->condition[condition];
  ViewEnvironment plain =
      plain_environment(c, request_->air, range_m_, {}, {}, sun_shines(c), *node_um_);
  LightBounds& b = known.emplace();
  const std::size_t n = node_um_->size();
  b.transmittance = std::move(plain.transmittance);
  b.path_radiance = std::move(plain.path_radiance);
  b.sun = std::move(plain.sun);
  b.thermal.assign(n, 0.0);
  for (std::uint32_t k = 0; k < plain.around.count(); ++k) {
    const std::vector<double> node = plain.around.radiance(k);
    for (std::size_t i = 0; i < n; ++i) b.thermal[i] = std::max(b.thermal[i], node[i]);
  }
  for (auto* none : {&b.diffuse_sun, &b.diffuse_sun_w_m2_um, &b.mirrored_sun,
                     &b.mirrored_sun_w_m2_um, &b.path_sun, &b.background_sun})
    none->assign(n, 0.0);
  return b;
}

ViewEnvironments ViewSurroundings::without_light() {
  ViewEnvironments out;
  out.horizon = horizon_;
  out.land_range_m = land_range_m_;
  out.land_bend_per_m = land_bend_per_m_;
  const std::vector<double> dark(node_um_->size(), 0.0);
  for (std::uint32_t c = 0; c < request_->condition.size(); ++c) {
    const LightBounds& b = bounds(c);
    ViewEnvironment& e = out.condition.emplace_back();
    e.transmittance = b.transmittance;
    e.path_radiance = b.path_radiance;
    e.sun = e.sun_apparent = dark;
    e.background_apparent = {dark, dark};
    e.around = IncidentRadiance::of_spectra(e.background_apparent, e.background_apparent);
  }
  return out;
}

absl::StatusOr<ViewEnvironments> ViewSurroundings::evaluate(
    std::span<const std::uint32_t> conditions, const EffectSet& effects) {
  ViewEnvironments out;
  out.condition.resize(request_->condition.size());
  out.behind = behind_;
  out.land_range_m = land_range_m_;
  out.land_bend_per_m = land_bend_per_m_;
  out.horizon = horizon_;
  if (!look_) {
    for (const std::uint32_t c : conditions) {
      const ConditionSpec& spec = request_->condition[c];
      out.condition[c] = plain_environment(spec, request_->air, range_m_, end_, land_range_m_,
                                           sun_shines(spec), *node_um_);
    }
    return out;
  }
  const bool reflected = effects.surroundings();
  // The choice must not depend on the conditions that are asked for.
  bool with_azimuths = false;
  for (std::uint32_t c = 0; c < effects.sun.size(); ++c)
    with_azimuths |= effects.scattered_sun(c) && request_->environment->sun_seen(c).lights_air;
  EffectSet wanted = effects;
  if (!with_azimuths)
    for (EffectSet::Sun& sun : wanted.sun) sun.diffuse = false;
  if (reflected) out.directions = request_->environment->nodes(with_azimuths);
  for (const std::uint32_t c : conditions) {
    ASSIGN_OR_RETURN(out.condition[c], look_->evaluate(c, wanted, with_azimuths));
  }
  return out;
}

absl::StatusOr<ViewEnvironment> ViewSurroundings::see_like(const ViewEnvironments& other,
                                                           std::uint32_t condition,
                                                           const EffectSet& effects) {
  const ConditionSpec& spec = request_->condition[condition];
  if (!look_)
    return plain_environment(spec, request_->air, range_m_, end_, land_range_m_, sun_shines(spec),
                             *node_um_);
  const bool with_azimuths = other.directions.azimuths() > 1;
  EffectSet wanted = effects;
  if (!with_azimuths)
    for (EffectSet::Sun& sun : wanted.sun) sun.diffuse = false;
  return look_->evaluate(condition, wanted, with_azimuths);
}

absl::StatusOr<ViewEnvironments> view_environments(const ViewRequest& request, const Target& target,
                                                   double range_m,
                                                   std::span<const std::uint32_t> conditions,
                                                   const std::vector<double>& node_um) {
  ASSIGN_OR_RETURN(auto surroundings, ViewSurroundings::make(request, target, range_m, node_um));
  // Directions also where a request allows no reflections: profiles see the background by them.
  return surroundings.evaluate(
      conditions,
      EffectSet::everything(request.condition.size(), std::max(request.max_reflections, 1u)));
}

}  // namespace irsig
