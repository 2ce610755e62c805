#include "core/sources/view_sources.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/constants.h"

namespace irsig {

Boundary boundary_of(const ConditionSpec& condition, double surface_z_m,
                     const Environment::Horizon* horizon) {
  Plane plane{surface_z_m, kEarthRadiusM};
  if (horizon) {
    plane.earth_radius_m = horizon->earth_radius_m;
    plane.lift_rad = horizon->lift_rad;
  }
  switch (condition.surroundings.kind) {
    case SurroundingsKind::kSea:
      return Sea{plane};
    case SurroundingsKind::kGround:
      return Ground{plane};
    case SurroundingsKind::kNone:
      break;
  }
  return NoBoundary{};
}

ViewSources::ViewSources(const SourceRequest& request, const EffectSet& effects,
                         std::shared_ptr<const ViewEnvironments> environments,
                         const std::vector<double>& node_um)
    : environments_(std::move(environments)) {
  if (request.emitters) geometry_.emitters = *request.emitters;
  // Paths are traced once for all conditions: theirs is one boundary (check_request).
  const std::optional<Environment::Horizon>& horizon = environments_->horizon;
  double lowest_m = INFINITY, highest_m = 0;
  for (const ConditionSpec& c : request.condition) {
    lowest_m = std::min(lowest_m, c.above_surface_m);
    highest_m = std::max(highest_m, c.above_surface_m);
  }
  geometry_.boundary = boundary_of(request.condition.front(), request.surface_z_m + lowest_m,
                                   horizon ? &*horizon : nullptr);
  // With targets at several heights the Earth hides nothing (check_in_sight).
  if (lowest_m < highest_m) {
    if (Plane* plane = std::get_if<Sea>(&geometry_.boundary)) plane->earth_radius_m = 0;
    if (Plane* plane = std::get_if<Ground>(&geometry_.boundary)) plane->earth_radius_m = 0;
  }
  if (request.land)
    geometry_.boundary = Land(request.land, request.surface_z_m + lowest_m, request.centre,
                              environments_->land_range_m, environments_->land_bend_per_m);
  if (horizon) geometry_.horizon_z = horizon->z;
  geometry_.directions = environments_->directions;
  if (geometry_.directions.uniform() && lowest_m > 0 &&
      !std::holds_alternative<NoBoundary>(geometry_.boundary)) {
    geometry_.around_horizon_z = sine_of_dip(lowest_m);
  }
  if (request.contrast) geometry_.behind = environments_->behind;
  // Conditions whose suns stand at the same place share paths.
  const auto place_of = [this](const SunDirection& sun) {
    std::vector<SunDirection>& suns = geometry_.sun;
    const auto same = std::find(suns.begin(), suns.end(), sun);
    const auto index = static_cast<std::uint32_t>(same - suns.begin());
    if (same == suns.end()) suns.push_back(sun);
    return index;
  };
  std::vector<std::vector<LitSun>> lit;
  for (const std::uint32_t c : request.wanted) {
    const ConditionSpec& condition = request.condition[c];
    const ViewEnvironment& environment = environments_->condition[c];
    std::vector<LitSun>& here = lit.emplace_back();
    // Land that a sun shines on is met by rays, whether or not the sun itself is.
    const bool lights_land =
        request.land && (effects.scattered_sun(c) || effects.sun[c].background);
    if (sun_shines(condition) && (effects.follows_sun(c) || lights_land))
      here.push_back(
          {place_of({condition.sun_direction,
                     condition.sun_angular_radius_deg * std::numbers::pi / 180, 0,
                     effects.sun[c].mirrored ? condition.sea_wind_m_s : 0, condition.sun_horizon_z,
                     condition.above_surface_m > 0 ? condition.sun_horizon_z : 0}),
           effects.sun[c].direct, environment.sun, environment.sun_apparent});
  }
  // Extremes are over all conditions, so that no bit depends on the selected ones.
  double coldest_k = 0, hottest_k = 0;
  for (const ConditionSpec& c : request.condition) {
    if (!c.emitter || c.emitter->hottest_k == 0) continue;
    coldest_k = hottest_k == 0 ? c.emitter->coldest_k : std::min(coldest_k, c.emitter->coldest_k);
    hottest_k = std::max(hottest_k, c.emitter->hottest_k);
  }
  const SourceLayout paths(request.parts, geometry_);
  BlackbodyNodes nodes;
  std::uint32_t emitters = paths.emitters();
  if (hottest_k > 0) {
    nodes = BlackbodyNodes(coldest_k, hottest_k);
    emitters = static_cast<std::uint32_t>(request.parts) + nodes.count();
  }
  layout_ = SourceLayout::of_light(emitters, geometry_);
  condition_.reserve(request.wanted.size());
  one_sky_.reserve(request.wanted.size());
  for (std::size_t i = 0; i < request.wanted.size(); ++i) {
    const std::uint32_t c = request.wanted[i];
    std::optional<ConditionSources>& one_sky = one_sky_.emplace_back();
    if (const ViewEnvironment* sky = environments_->condition[c].one_sky.get(); sky != nullptr) {
      std::vector<LitSun> suns = lit[i];
      for (LitSun& sun : suns) {
        sun.irradiance = sky->sun;
        sun.apparent = sky->sun_apparent;
      }
      one_sky.emplace(request.condition[c], *sky, geometry_, LightLayout{paths, layout_, nodes},
                      std::move(suns), node_um, effects, request.land_emissivity);
    }
    condition_.emplace_back(request.condition[c], environments_->condition[c], geometry_,
                            LightLayout{paths, layout_, nodes}, std::move(lit[i]), node_um, effects,
                            request.land_emissivity);
  }
}

}  // namespace irsig
