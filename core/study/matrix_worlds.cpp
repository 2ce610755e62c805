#include "core/study/matrix_worlds.h"

#include <string>
#include <utility>
#include <variant>

#include "core/base/status_macros.h"
#include "core/geo/frames.h"
#include "core/materials/optical/material_library.h"

namespace irsig {

Band mid_wave_band() { return {"mwir", 3, 5, 0.1, {}}; }
Band long_wave_band() { return {"lwir", 8, 12, 0.2, {}}; }

MaterialSpec matt_paint(double emissivity) { return {"paint", Lambert{{{0, emissivity}}}}; }

absl::StatusOr<MaterialSpec> bare_aluminium(double roughness) {
  ASSIGN_OR_RETURN(auto entry, library_entry("aluminium"));
  MaterialSpec spec = std::move(entry.spec);
  if (roughness > 0) std::get<CookTorrance>(spec.model).roughness = roughness;
  return spec;
}

WeatherSpec open_sea() {
  return {{afgl_profile(AfglProfile::kMidlatitudeSummer), {AerosolKind::kMaritime, 23e3}},
          true,
          {SurfaceBoundary::Kind::kRoughSea, 288, 1, 5},
          nullptr};
}

WeatherSpec bare_land() {
  return {{afgl_profile(AfglProfile::kMidlatitudeSummer), {AerosolKind::kRural, 23e3}},
          true,
          {SurfaceBoundary::Kind::kGround, 290, 0.95, 0},
          nullptr};
}

WeatherSpec sea_fog(double visibility_m) {
  WeatherSpec weather = open_sea();
  weather.air.aerosol = {AerosolKind::kAdvectionFog, visibility_m};
  return weather;
}

ConditionSpec condition_over(const WeatherSpec& weather, std::vector<double> part_temperature_k) {
  ConditionSpec condition;
  condition.part_temperature_k = std::move(part_temperature_k);
  // The embedded atmosphere takes the place of all but the kind: the target stands on the ground as
  // it floats on the sea.
  condition.surroundings.kind = SurroundingsKind::kSea;
  condition.surroundings.sea_temperature_k = weather.lower.temperature_k;
  if (weather.lower.kind == SurfaceBoundary::Kind::kRoughSea)
    condition.sea_wind_m_s = weather.lower.wind_speed_m_s;
  condition.air_temperature_k = weather.air.profile.level.front().temperature_k;
  return condition;
}

void add_sun(ConditionSpec& condition, Vec<Body> direction) {
  condition.sun = true;
  condition.sun_direction = direction;
  condition.sun_cos_zenith = -direction.z;
  condition.sun_angular_radius_deg = 0.2665;  // at 1 AU
  condition.sun_scale = 1;
}

void add_sun(ConditionSpec& condition, double azimuth_deg, double elevation_deg) {
  add_sun(condition, body_from_aspect(azimuth_deg, elevation_deg));
}

std::vector<Viewpoint> grid_of(const std::vector<std::array<double, 2>>& aspect_deg,
                               double range_m) {
  std::vector<Viewpoint> out;
  for (const auto& [azimuth_deg, elevation_deg] : aspect_deg)
    out.push_back({azimuth_deg, elevation_deg, range_m});
  return out;
}

}  // namespace irsig
