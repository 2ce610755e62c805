#include "messages/environment/weather_from_message.h"

#include <algorithm>
#include <array>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/thermal/condensation.h"
#include "messages/environment/named.h"

namespace irsig {
namespace {

constexpr std::array<const char*, 8> kAerosolNames = {
    "none",         "rural",         "urban",         "maritime",
    "tropospheric", "navy_maritime", "advection_fog", "radiation_fog"};

absl::StatusOr<SurfaceBoundary> lower_from_message(const schema::Surroundings& s,
                                                   double wind_speed_m_s) {
  using Kind = SurfaceBoundary::Kind;
  const auto is_ground =
      named<bool>("surroundings.kind", s.kind(), {{"sea", false}, {"ground", true}});
  if (!is_ground.ok()) return is_ground.status();
  SurfaceBoundary lower;
  if (*is_ground) {
    lower.kind = Kind::kGround;
    lower.temperature_k = s.ground_temperature_k();
    lower.emissivity = s.ground_emissivity();
    return lower;
  }
  const auto kind = named<Kind>(
      "surroundings.sea_model", s.sea_model(),
      {{"cox_munk", Kind::kRoughSea}, {"flat", Kind::kFlatSea}, {"grey", Kind::kGreySea}});
  if (!kind.ok()) return kind.status();
  lower.kind = *kind;
  lower.temperature_k = s.sea_temperature_k();
  if (lower.kind == Kind::kRoughSea) lower.wind_speed_m_s = wind_speed_m_s;
  if (lower.kind == Kind::kGreySea) lower.emissivity = s.sea_emissivity();
  return lower;
}

}  // namespace

bool has_atmosphere(const schema::ResolvedSweep& sweep) {
  return sweep.sweep().air().model() == "atmosphere";
}

bool is_rough_sea(const schema::Surroundings& surroundings) {
  return surroundings.sea_model() == "cox_munk";
}

double target_height_m(const schema::ResolvedSweep& sweep) {
  constexpr double kModelFromFileM = 5;
  if (sweep.sweep().place().has_above_surface_m()) return kLowestAirPointM;
  const schema::Model& model = sweep.sweep().model();
  const double raised_m = model.offset_m_size() == 3 ? std::max(0.0, model.offset_m(2)) : 0;
  if (!model.has_generate()) return kModelFromFileM + raised_m;
  // The frigate's mast rises as high above its deck as that above the water, and more.
  const bool ship = model.generate() == "frigate";
  return std::max(1.0, ship ? model.height_m() : model.height_m() / 2) + raised_m;
}

double above_surface_m(const schema::ResolvedSweep& sweep, const schema::Condition& condition) {
  return condition.has_weather() ? condition.weather().above_surface_m()
                                 : sweep.sweep().place().above_surface_m();
}

double air_point_height_m(const schema::ResolvedSweep& sweep, double above_surface_m) {
  return above_surface_m > 0 ? std::max(above_surface_m, kLowestAirPointM) : target_height_m(sweep);
}

absl::StatusOr<Air> air_from_message(const schema::Air& message) {
  // Behind the embedded atmosphere there is no other air.
  const auto model = named<AirModel>("air.model", message.model(),
                                     {{"vacuum", AirModel::kVacuum},
                                      {"homogeneous", AirModel::kHomogeneous},
                                      {"atmosphere", AirModel::kVacuum}});
  if (!model.ok()) return model.status();
  Air air;
  air.model = *model;
  air.absorption_m2_kg = message.absorption_m2_kg();
  air.pressure_pa = message.pressure_pa();
  air.gas_constant_j_kg_k = message.gas_constant_j_kg_k();
  air.path_emission = message.path_emission();
  return air;
}

std::span<const char* const> aerosol_names() { return kAerosolNames; }

absl::StatusOr<AerosolKind> aerosol_named(std::string_view name) {
  for (std::size_t i = 0; i < kAerosolNames.size(); ++i) {
    if (name == kAerosolNames[i]) return static_cast<AerosolKind>(i);
  }
  return keyed_problem("air.aerosol", absl::StrCat("there is no \"", std::string(name), "\""));
}

absl::StatusOr<AirProfile> profile_from_message(const schema::Weather& weather) {
  ASSIGN_OR_RETURN(const auto base, afgl_profile_named(weather.profile()));
  AirProfile profile = afgl_profile(base);
  if (!weather.profile_csv().empty()) {
    ASSIGN_OR_RETURN(profile, parse_profile_csv(weather.profile_csv(), weather.profile_file_name(),
                                                profile, weather.place_height_m()));
  }
  ASSIGN_OR_RETURN(profile, profile_above(profile, weather.place_height_m()));
  if (!weather.surface_stated()) return profile;
  return bend_to_surface(profile, {.air_temperature_k = weather.air_temperature_k(),
                                   .relative_humidity_percent = weather.relative_humidity_percent(),
                                   .pressure_pa = weather.pressure_pa()});
}

absl::StatusOr<CloudSpec> cloud_from_message(const schema::CloudLayer& layer) {
  const auto phase = named<CloudPhase>("cloud.phase", layer.phase(),
                                       {{"water", CloudPhase::kWater}, {"ice", CloudPhase::kIce}});
  if (!phase.ok()) return phase.status();
  constexpr double kKgPerG = 1e-3;
  CloudSpec out{*phase, layer.base_m(), layer.top_m(), kKgPerG * layer.water_path_g_m2(),
                layer.effective_radius_um()};
  RETURN_IF_ERROR(check_cloud(out));
  return out;
}

absl::StatusOr<WeatherSpec> weather_from_message(const schema::Weather& weather,
                                                 const schema::Surroundings& surroundings) {
  WeatherSpec spec;
  ASSIGN_OR_RETURN(auto profile, profile_from_message(weather));
  spec.air.profile = std::move(profile);
  ASSIGN_OR_RETURN(const auto kind, aerosol_named(weather.aerosol()));
  spec.air.aerosol = {.kind = kind,
                      .visibility_m = weather.visibility_m(),
                      .air_mass = weather.air_mass(),
                      .wind_speed_m_s = weather.wind_speed_m_s(),
                      .wind_speed_24h_m_s = weather.wind_speed_24h_m_s(),
                      .summer_troposphere = weather.summer_troposphere()};
  RETURN_IF_ERROR(check_aerosol(spec.air.aerosol));
  spec.air.co2_ppmv = weather.co2_ppmv();
  spec.refraction = weather.refraction();
  spec.above_surface_m = weather.above_surface_m();
  spec.cloud_cover = weather.cloud_cover();
  if (weather.cloud_cover() > 0) {
    ASSIGN_OR_RETURN(spec.cloud, cloud_from_message(weather.cloud()));
    if (weather.cloud().base_from_weather() || weather.cloud().base_of_risen_air()) {
      const auto risen_k = [&](double height_m) {
        return risen_air_k(weather.air_temperature_k(), weather.relative_humidity_percent(),
                           weather.pressure_pa(), height_m);
      };
      spec.cloud->base_k = risen_k(spec.cloud->base_m);
      if (weather.cloud().base_from_weather() && !weather.cloud().base_is_input()) {
        spec.cloud_base_range_m = {kLowestCondensationM, kHighestCondensationM};
        spec.cloud_base_range_k = {risen_k(kLowestCondensationM), risen_k(kHighestCondensationM)};
      }
    }
    // A type's water path is one of many.
    if (!weather.cloud().water_path_stated() && !weather.cloud().water_path_is_input())
      spec.cloud_water_range = {0.5, 2};
  }
  ASSIGN_OR_RETURN(auto lower, lower_from_message(surroundings, weather.wind_speed_m_s()));
  spec.lower = lower;
  if (!weather.modtran_text().empty()) {
    ASSIGN_OR_RETURN(auto imported,
                     parse_imported_paths(weather.modtran_text(), weather.modtran_file_name()));
    spec.imported = std::make_shared<const ImportedPaths>(std::move(imported));
  }
  return spec;
}

}  // namespace irsig
