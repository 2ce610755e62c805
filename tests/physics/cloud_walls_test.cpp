// Rationale: walls have the sky of a formula, rows that of the atmosphere: one cloud, or one fog,
// for both. Expected: the irradiance of both skies within 3 %; the sky measured at Alamosa between
// those of the bases that a cloud of unknown type may have.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "core/atmosphere/fog_sky.h"
#include "core/base/constants.h"
#include "core/thermal/clear_sky.h"
#include "core/thermal/condensation.h"
#include "core/thermal/weather_course.h"
#include "tests/physics/cloud_fixture.h"

namespace irsig {
namespace {

using namespace cloud_fixture;

constexpr double kNoonS = 1735702000;

// Radiation on walls in the profile's surface weather.
CourseRadiation walls_under(const AirProfile& air, SkyAerosol sky, double cover) {
  const AirLevel& surface = air.level.front();
  WeatherRecord now;
  now.air_k = surface.temperature_k;
  now.dew_point_k = dew_point_k(relative_humidity_percent(surface) / 100 *
                                vapour_pressure_pa(surface.temperature_k));
  now.pressure_pa = surface.pressure_pa;
  now.cloud_cover = cover;
  WeatherCourse course{{now, now}, 0, false};
  course.record[0].unix_s = 1735700400;
  course.record[1].unix_s = 1735704000;
  return CourseRadiation::make(course, {49.5, 0, 0}, std::move(sky)).value();
}

// Walls have the sky of a formula, rows that of the atmosphere: one cloud for both.
TEST(CloudSky, WarmsWallsAsItsHemisphere) {
  for (const AfglProfile of :
       {AfglProfile::kMidlatitudeSummer, AfglProfile::kMidlatitudeWinter,
        AfglProfile::kSubarcticWinter, AfglProfile::kUsStandard1976, AfglProfile::kTropical}) {
    for (const double base_m : {330.0, 1000.0, 2500.0}) {
      const CloudSpec cloud{CloudPhase::kWater, base_m, base_m + 670, 0.2, 7.9};
      const Sky sky(of, AerosolKind::kRural, &cloud);
      CloudAbove above;
      for (const AirLevel& level : sky.weather.air.profile.level) {
        above.height_m.push_back(level.height_m);
        above.air_k.push_back(level.temperature_k);
      }
      above.base_m = base_m;
      const CourseRadiation walls =
          walls_under(sky.weather.air.profile, {0.2, 0.1, 0.3, 0.2, std::move(above)}, 1);
      const double of_view = hemisphere_w_m2(sky);
      EXPECT_NEAR(walls.at(kNoonS).sky_w_m2, of_view, 0.03 * of_view)
          << name_of(of) << " " << base_m;
    }
  }
}

// Walls in fog that is stated as aerosol have the fog's sky, and not that of clear air.
TEST(FogSky, WarmsWallsAsItsHemisphere) {
  for (const AfglProfile of :
       {AfglProfile::kMidlatitudeSummer, AfglProfile::kMidlatitudeWinter,
        AfglProfile::kSubarcticWinter, AfglProfile::kUsStandard1976, AfglProfile::kTropical}) {
    for (const AerosolKind kind : {AerosolKind::kAdvectionFog, AerosolKind::kRadiationFog}) {
      for (const double visibility_m : {200.0, 500.0, 1000.0, 4000.0}) {
        const AirLevel surface = afgl_profile(of).level.front();
        const AirProfile air =
            *bend_to_surface(afgl_profile(of), {surface.temperature_k, 98, surface.pressure_pa});
        const AerosolSpec fog{.kind = kind, .visibility_m = visibility_m};
        const Sky sky(air, fog, nullptr);
        const FogSky above = fog_sky(fog, air);
        EXPECT_GT(above.emissivity, 0.2);
        EXPECT_LE(above.emissivity, 1);
        const CourseRadiation walls =
            walls_under(air, {0.2, 0.1, 0.3, 0.2, {}, above.emissivity, above.colder_k}, 0);
        const double of_view = hemisphere_w_m2(sky);
        // Above thin fog the clear sky's formula counts, which errs by up to 8 % in winter air.
        EXPECT_NEAR(walls.at(kNoonS).sky_w_m2, of_view,
                    (visibility_m <= 1000 ? 0.03 : 0.06) * of_view)
            << name_of(of) << " " << visibility_m << " " << static_cast<int>(kind);
      }
    }
  }
}

TEST(FogSky, IsNoneWithoutFogAndBlackInDeepFog) {
  const AirProfile& air = afgl_profile(AfglProfile::kMidlatitudeSummer);
  EXPECT_EQ(fog_sky({.kind = AerosolKind::kRural, .visibility_m = 1000}, air).emissivity, 0);
  const FogSky deep = fog_sky({.kind = AerosolKind::kAdvectionFog, .visibility_m = 100}, air);
  EXPECT_GT(deep.emissivity, 0.9999);
  // It is as warm as the lowest 100 m.
  EXPECT_GT(deep.colder_k, 0);
  EXPECT_LT(deep.colder_k, 0.5);
  AirProfile isothermal = air;
  for (AirLevel& level : isothermal.level) level.temperature_k = 280;
  EXPECT_NEAR(
      fog_sky({.kind = AerosolKind::kRadiationFog, .visibility_m = 500}, isothermal).colder_k, 0,
      1e-6);
  // A deck above fog sends what the fog lets pass.
  const auto with_deck = [&](double fog_emissivity) {
    CloudAbove deck;
    deck.height_m = {0, 2000};
    deck.air_k = {290, 280};
    deck.base_m = 1000;
    const CourseRadiation walls =
        walls_under(air, {0.2, 0.1, 0.3, 0.2, deck, fog_emissivity, 0}, 1);
    const CourseRadiation clear = walls_under(air, {0.2, 0.1, 0.3, 0.2, {}, fog_emissivity, 0}, 0);
    return walls.at(kNoonS).sky_w_m2 - clear.at(kNoonS).sky_w_m2;
  };
  EXPECT_NEAR(with_deck(0.75), 0.25 * with_deck(0), 1e-9);
}

// Rationale: measured at Alamosa, 1 January 2016, 02:56 UTC: 239.4 W/m2 under an overcast sky whose
// base was not measured. Expected: the walls' sky lies between those of the bases that a cloud of
// unknown type may have, 300 and 2500 m, and so does the measurement. With the default base, twice
// the level of condensation, it is within 12 W/m2 of the measurement. Rows have the same base, and
// their hemisphere the same irradiance within 3 %. Source: the measured irradiance, air temperature
// and humidity; 770 hPa is taken for 2300 m.
TEST(CloudSky, BasesOfRisenAirHaveTheSkyOfAlamosaBetweenThem) {
  constexpr double kAirK = 261.05, kPercent = 67.7, kPressurePa = 77000, kMeasuredWM2 = 239.4,
                   kPlaceM = 2300;
  const AirProfile air =
      *bend_to_surface(*profile_above(afgl_profile(AfglProfile::kMidlatitudeWinter), kPlaceM),
                       {kAirK, kPercent, kPressurePa});
  WeatherRecord now;
  now.air_k = kAirK;
  now.dew_point_k = dew_point_k(kPercent / 100 * vapour_pressure_pa(kAirK));
  now.pressure_pa = kPressurePa;
  now.cloud_cover = 1;
  CloudAbove above;
  for (const AirLevel& level : air.level) {
    above.height_m.push_back(level.height_m);
    above.air_k.push_back(level.temperature_k);
  }
  const double base_m = base_height_m(above, now), base_k = base_temperature_k(above, now);
  EXPECT_NEAR(base_m, 1162, 1);
  EXPECT_LT(base_k, condensation_temperature_k(kAirK, kPercent) - 4);
  const double emissivity = sky_emissivity_prata(kAirK, vapour_pressure_pa(now.dew_point_k));
  const auto sky_w_m2 = [&](double kelvin) {
    return kStefanBoltzmannWM2K4 *
           (emissivity * std::pow(kAirK, 4) + (1 - emissivity) * std::pow(kelvin, 4));
  };
  const double low = sky_w_m2(risen_air_k(kAirK, kPercent, kPressurePa, 2500)),
               high = sky_w_m2(risen_air_k(kAirK, kPercent, kPressurePa, 300)),
               own = sky_w_m2(base_k);
  EXPECT_LT(low, kMeasuredWM2 + 0.5);
  EXPECT_GT(high, own);
  EXPECT_LT(own - kMeasuredWM2, 2 * (own - low) / std::sqrt(3));
  EXPECT_NEAR(own, 251.2, 0.1);
  EXPECT_LT(own - kMeasuredWM2, 12);
  struct Base {
    double base_m, risen_w_m2, profile_w_m2;
  };
  for (const Base& of :
       {Base{300, 259.8, 262.6}, Base{1000, 252.7, 260.0}, Base{1500, 248.2, 257.4},
        Base{2000, 243.7, 254.9}, Base{2500, 239.4, 251.6}}) {
    EXPECT_NEAR(sky_w_m2(risen_air_k(kAirK, kPercent, kPressurePa, of.base_m)), of.risen_w_m2, 0.1);
    EXPECT_NEAR(sky_w_m2(air_at(air, of.base_m).temperature_k), of.profile_w_m2, 0.1);
  }
  // The air of the standard profile has no inversion there, and yet is warmer than risen air.
  for (const double height_m : {500.0, 1000.0, 2000.0})
    EXPECT_LT(air_at(air, height_m).temperature_k, air_at(air, height_m - 400).temperature_k);
  EXPECT_GT(sky_w_m2(air_at(air, base_m).temperature_k), own + 4);
  // Rows have the same base.
  const CloudSpec cloud{CloudPhase::kWater, base_m, base_m + 670, 0.2, 7.9, base_k};
  const AirProfile cloudy = with_cloud(air, cloud);
  EXPECT_NEAR(air_at(cloudy, base_m).temperature_k, base_k, 1e-9);
  EXPECT_NEAR(relative_humidity_percent(air_at(cloudy, base_m)), 100, 1e-6);
  EXPECT_NEAR(air_at(cloudy, base_m - 2).temperature_k, air_at(air, base_m - 2).temperature_k,
              1e-2);
  EXPECT_TRUE(check_profile(cloudy).ok());
  const Sky rows(air, {.kind = AerosolKind::kRural, .visibility_m = 23e3}, &cloud);
  const double of_rows = hemisphere_w_m2(rows);
  RecordProperty("rows_w_m2", std::to_string(of_rows));
  EXPECT_NEAR(of_rows, own, 0.03 * own);
}

// Rationale: the default cloud is no fit to one night. Expected: the walls' sky under a cloud of
// unknown type against the sky that was measured in overcast hours of another place and climate:
// in the mean within 5 W/m2, rms within 12 W/m2.
// Source: every twelfth of the 216 half hours in which Champaign (40.01 N, 88.37 W, 1998) had less
// than a quarter of a clear day's sunlight (three half hours in a row, sun 11.5 deg or higher):
// long-wave radiation = net radiation - 0.82 x sunlight + sigma x (surface temperature)^4, Noah
// land-surface model 2.7.1's forcing and validation data (NOAA/ARL, T. Meyers). Two streams of net
// radiation make it uncertain by some 10 W/m2.
TEST(CloudSky, OfUnknownTypeIsAsWarmAsOvercastSkiesOfChampaign) {
  struct HalfHour {
    double air_k, percent, pressure_pa, sky_w_m2;
  };
  constexpr HalfHour kMeasured[] = {
      {285.25, 94.0, 99200, 368.8},  {266.05, 76.9, 99900, 293.3}, {272.75, 104.1, 99100, 321.2},
      {273.75, 72.9, 99100, 324.5},  {271.25, 91.4, 98600, 312.8}, {267.25, 100.2, 99400, 292.0},
      {274.35, 99.2, 99000, 320.2},  {274.25, 99.7, 98800, 324.7}, {281.25, 75.7, 99100, 341.2},
      {281.45, 94.7, 97200, 354.3},  {274.25, 93.1, 99100, 324.5}, {296.27, 100.0, 99200, 428.7},
      {296.41, 100.0, 98900, 422.0}, {281.75, 99.8, 98600, 362.7}, {275.85, 94.4, 99100, 315.2},
      {276.15, 93.4, 99300, 332.9},  {278.35, 94.9, 99400, 346.2}, {287.75, 96.2, 98100, 388.7}};
  double sum = 0, squares = 0;
  for (const HalfHour& of : kMeasured) {
    WeatherRecord now;
    now.air_k = of.air_k;
    const double vapour_pa = std::min(1.0, of.percent / 100) * vapour_pressure_pa(of.air_k);
    now.dew_point_k = dew_point_k(vapour_pa);
    now.pressure_pa = of.pressure_pa;
    now.cloud_cover = 1;
    CloudAbove above;
    above.height_m = {0, 5000};
    above.air_k = {of.air_k, of.air_k - 30};
    const double emissivity = sky_emissivity_prata(of.air_k, vapour_pa);
    const double sky =
        kStefanBoltzmannWM2K4 * (emissivity * std::pow(of.air_k, 4) +
                                 (1 - emissivity) * std::pow(base_temperature_k(above, now), 4));
    sum += sky - of.sky_w_m2;
    squares += std::pow(sky - of.sky_w_m2, 2);
  }
  const double count = std::size(kMeasured), mean = sum / count, rms = std::sqrt(squares / count);
  RecordProperty("mean_w_m2", std::to_string(mean));
  RecordProperty("rms_w_m2", std::to_string(rms));
  EXPECT_LT(std::abs(mean), 5);
  EXPECT_LT(rms, 12);
}

}  // namespace
}  // namespace irsig
