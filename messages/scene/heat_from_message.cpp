#include "messages/scene/heat_from_message.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/atmosphere/air_column.h"
#include "core/atmosphere/cloud.h"
#include "core/atmosphere/fog_sky.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/materials/optical/material_library.h"
#include "core/materials/total_emissivity.h"
#include "messages/environment/named.h"
#include "messages/environment/weather_from_message.h"

namespace irsig {

absl::StatusOr<WallBuildUp> wall_from_message(const schema::BuildUp& message,
                                              const std::string& path) {
  const auto side = named<InnerSide>(path + ".inside", message.inside(),
                                     {{"adiabatic", InnerSide::kAdiabatic},
                                      {"heat_flux", InnerSide::kHeatFlux},
                                      {"air", InnerSide::kAir},
                                      {"temperature", InnerSide::kFixedTemperature},
                                      {"open", InnerSide::kOpen}});
  if (!side.ok()) return side.status();
  WallBuildUp out;
  out.name = message.name();
  for (const schema::Layer& l : message.layer())
    out.layers.push_back(
        {l.thickness_m(), l.conductivity_w_m_k(), l.density_kg_m3(), l.specific_heat_j_kg_k()});
  if (const absl::Status status = check_layers(out.layers); !status.ok())
    return at_key(path, status);
  out.inner_side = *side;
  out.inner_k = message.inside_temperature_k();
  out.inner_h_w_m2_k = message.inside_h_w_m2_k();
  out.inner_flux_w_m2 = message.inside_heat_flux_w_m2();
  if (message.has_surface_moisture() || message.has_canopy()) {
    SurfaceWater& water = out.water.emplace();
    water.moisture = message.surface_moisture();
    if (message.has_canopy())
      water.canopy = {message.canopy().leaf_area_index(),
                      message.canopy().stomatal_resistance_s_m()};
    if (const absl::Status status = check_water(water); !status.ok()) return at_key(path, status);
  }
  return out;
}

WeatherCourse course_from_message(const schema::WeatherCourse& message) {
  WeatherCourse out;
  out.radiation_interval_s = message.radiation_interval_s();
  out.periodic = message.periodic();
  for (const schema::WeatherRecord& r : message.record()) {
    WeatherRecord& to = out.record.emplace_back();
    to.unix_s = r.unix_s();
    to.air_k = r.air_temperature_k();
    to.dew_point_k = r.dew_point_k();
    to.pressure_pa = r.pressure_pa();
    to.wind_m_s = r.wind_speed_m_s();
    to.wind_from_deg = r.wind_from_deg();
    to.cloud_cover = r.cloud_cover();
    if (r.has_direct_normal_w_m2()) to.direct_normal_w_m2 = r.direct_normal_w_m2();
    if (r.has_diffuse_horizontal_w_m2()) to.diffuse_horizontal_w_m2 = r.diffuse_horizontal_w_m2();
    if (r.has_sky_w_m2()) to.sky_w_m2 = r.sky_w_m2();
  }
  return out;
}

absl::StatusOr<GroundBoundary> ground_from_message(const schema::Sweep& sweep,
                                                   const schema::Surroundings& s) {
  GroundBoundary out;
  if (s.kind() == "ground") {
    out.temperature_k = s.ground_temperature_k();
    out.emissivity = s.ground_emissivity();
  } else if (s.kind() == "sea") {
    out.water = true;
    out.temperature_k = s.sea_temperature_k();
    out.flow_m_s = sweep.place().speed_m_s();
    out.emissivity = s.sea_emissivity();
    if (s.sea_model() != "grey") {
      ASSIGN_OR_RETURN(const auto water, library_entry("sea_water"));
      ASSIGN_OR_RETURN(const auto total, total_emissivity(water.spec, out.temperature_k));
      out.emissivity = total.value;
    }
  } else {
    return problem_status({{"", "surroundings.kind",
                            absl::StrCat("surroundings.kind = \"", s.kind(),
                                         "\": temperatures are computed above a sea or ground")}});
  }
  out.solar_albedo = s.solar_albedo();
  return out;
}

absl::StatusOr<CloudAbove> cloud_above(const schema::CloudLayer& layer, const AirProfile& profile) {
  ASSIGN_OR_RETURN(const CloudSpec spec, cloud_from_message(layer));
  CloudAbove out;
  const double ground_m = profile.level.front().height_m;
  for (const AirLevel& level : profile.level) {
    if (level.height_m - ground_m > kHighestCloudM) break;
    out.height_m.push_back(level.height_m - ground_m);
    out.air_k.push_back(level.temperature_k);
  }
  if (!layer.base_from_weather()) out.base_m = spec.base_m;
  out.base_of_risen_air = layer.base_from_weather() || layer.base_of_risen_air();
  // In the middle of the window, where the sky is clear without it.
  constexpr double kWindowUm = 10.5, kDiffusivity = 1.66;
  ASSIGN_OR_RETURN(const std::size_t window, air_band(kWindowUm));
  out.emissivity =
      -std::expm1(-kDiffusivity * cloud_optics(spec, ForwardPeak::kDiffuse).absorption[window]);
  // Particles much larger than the wavelength take twice their cross section out of the beam.
  constexpr double kWaterKgM3 = 1000;
  // [kasten1980] is the mean of all covers: it takes thin ice for thick water.
  if (layer.water_path_stated() || spec.phase == CloudPhase::kIce)
    out.solar_depth = 1.5 * spec.water_path_kg_m2 / (kWaterKgM3 * 1e-6 * spec.effective_radius_um);
  return out;
}

absl::StatusOr<SkyAerosol> sky_from_message(const schema::HeatRun& heat, double solar_albedo) {
  ASSIGN_OR_RETURN(const auto weather, weather_from_message(heat.weather(), heat.surroundings()));
  const AerosolSpec& aerosol = weather.air.aerosol;
  const double humidity_percent = relative_humidity_percent(weather.air.profile.level.front());
  const FogSky fog = fog_sky(aerosol, weather.air.profile);
  SkyAerosol out{aerosol_depth(aerosol, humidity_percent, 380),
                 aerosol_depth(aerosol, humidity_percent, 500),
                 ozone_cm(weather.air.profile),
                 solar_albedo,
                 std::nullopt,
                 fog.emissivity,
                 fog.colder_k};
  if (heat.weather().has_cloud()) {
    ASSIGN_OR_RETURN(out.cloud, cloud_above(heat.weather().cloud(), weather.air.profile));
  }
  return out;
}

}  // namespace irsig
