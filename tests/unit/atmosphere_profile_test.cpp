// Profiles: the six standard ones, radiosondes in CSV and their errors, surface weather, defaults.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "absl/strings/str_cat.h"
#include "core/atmosphere/air_profile.h"
#include "core/atmosphere/atmosphere.h"

namespace irsig {
namespace {

using testing::HasSubstr;

const AirProfile& base() { return afgl_profile(AfglProfile::kMidlatitudeSummer); }

TEST(AtmosphereProfile, StandardProfilesAreSound) {
  for (const char* name : {"tropical", "midlatitude_summer", "midlatitude_winter",
                           "subarctic_summer", "subarctic_winter", "us_standard_1976"}) {
    const auto which = afgl_profile_named(name);
    ASSERT_TRUE(which.ok());
    EXPECT_EQ(name_of(*which), name);
    EXPECT_EQ(afgl_profile(*which).level.size(), 50U);
    EXPECT_TRUE(check_profile(afgl_profile(*which)).ok()) << check_profile(afgl_profile(*which));
  }
  EXPECT_THAT(afgl_profile_named("polar").status().message(), HasSubstr("subarctic_winter"));
  EXPECT_EQ(base().level[0].temperature_k, 294.2);
  EXPECT_EQ(base().level[0].gas.h2o_ppmv, 18800);
}

TEST(AtmosphereProfile, InterpolationKeepsLevelsAndIsExponential) {
  EXPECT_EQ(air_at(base(), 1000).pressure_pa, 90200);
  const AirLevel middle = air_at(base(), 500);
  EXPECT_NEAR(middle.pressure_pa, std::sqrt(101300.0 * 90200.0), 1e-6);
  EXPECT_NEAR(middle.temperature_k, 0.5 * (294.2 + 289.7), 1e-12);
  EXPECT_NEAR(middle.gas.h2o_ppmv, std::sqrt(18800.0 * 13800.0), 1e-6);
  EXPECT_EQ(air_at(base(), -5).pressure_pa, 101300);
}

TEST(AtmosphereProfile, SaturationPressure) {
  EXPECT_NEAR(saturation_pressure_pa(273.16), 611.66, 0.3);  // triple point
  EXPECT_NEAR(saturation_pressure_pa(293.15), 2339, 3);      // WMO tables
  EXPECT_NEAR(saturation_pressure_pa(313.15), 7384, 10);
}

TEST(AtmosphereProfile, SurfaceWeatherBendsTheLowestTwoKilometres) {
  const auto bent = bend_to_surface(base(), {285.0, 90.0, 100500.0});
  ASSERT_TRUE(bent.ok());
  EXPECT_TRUE(check_profile(*bent).ok());
  const AirLevel& surface = bent->level.front();
  EXPECT_EQ(surface.temperature_k, 285.0);
  EXPECT_EQ(surface.pressure_pa, 100500.0);
  EXPECT_NEAR(relative_humidity_percent(surface), 90, 1e-9);
  // Half of the difference at 1 km, none from 2 km on.
  EXPECT_NEAR(air_at(*bent, 1000).temperature_k, 289.7 - 0.5 * 9.2, 1e-9);
  EXPECT_NEAR(air_at(*bent, 2000).temperature_k, 285.2, 1e-9);
  EXPECT_EQ(air_at(*bent, 5000).temperature_k, air_at(base(), 5000).temperature_k);
  // Hydrostatic: the barometric formula over the lowest 100 m.
  EXPECT_NEAR(air_at(*bent, 100).pressure_pa,
              100500 * std::exp(-9.80665 * 28.9647e-3 * 100 / (8.314462618 * 284.7)), 10);
  EXPECT_FALSE(bend_to_surface(base(), {285.0, 101.0, 100500.0}).ok());
  EXPECT_FALSE(bend_to_surface(base(), {85.0, 50.0, 100500.0}).ok());
  EXPECT_FALSE(bend_to_surface(base(), {285.0, 50.0, 1005.0}).ok());
}

// A high place has the air of its own height above mean sea level.
TEST(AtmosphereProfile, BeginsAtThePlacesHeight) {
  const auto high = profile_above(base(), 2300);
  ASSERT_TRUE(high.ok()) << high.status();
  EXPECT_TRUE(check_profile(*high).ok()) << check_profile(*high);
  EXPECT_EQ(high->level.front().height_m, 0);
  for (const double up_m : {0.0, 100.0, 700.0, 5000.0, 30e3}) {
    const AirLevel there = air_at(*high, up_m), same = air_at(base(), 2300 + up_m);
    EXPECT_NEAR(there.temperature_k, same.temperature_k, 1e-9) << up_m;
    EXPECT_NEAR(there.pressure_pa, same.pressure_pa, 1e-9 * same.pressure_pa) << up_m;
    EXPECT_NEAR(there.gas.h2o_ppmv, same.gas.h2o_ppmv, 1e-9 * same.gas.h2o_ppmv) << up_m;
  }
  EXPECT_EQ(high->level.back().height_m, 120e3 - 2300);
  // On a level, and at or below the sea, no bit differs.
  EXPECT_EQ(profile_above(base(), 3000)->level.size(), base().level.size() - 3);
  for (const double place_m : {0.0, -430.0}) {
    const auto sea = profile_above(base(), place_m);
    ASSERT_TRUE(sea.ok());
    ASSERT_EQ(sea->level.size(), base().level.size());
    for (std::size_t i = 0; i < base().level.size(); ++i) {
      EXPECT_EQ(sea->level[i].height_m, base().level[i].height_m);
      EXPECT_EQ(sea->level[i].temperature_k, base().level[i].temperature_k);
    }
  }
  // Weather bends the lowest 2 km above the place.
  const auto bent = bend_to_surface(*high, {270, 60, 76500});
  ASSERT_TRUE(bent.ok()) << bent.status();
  EXPECT_NEAR(air_at(*bent, 2000).temperature_k, air_at(base(), 4300).temperature_k, 1e-9);
  EXPECT_TRUE(Atmosphere::make({*bent, {}}).ok());
  EXPECT_FALSE(profile_above(base(), 119.5e3).ok());
}

TEST(AtmosphereProfile, RadiosondeOfAHighPlaceBeginsThere) {
  const std::string header = "height_m,pressure_hpa,temperature_c,relative_humidity_percent\n";
  const auto read = [&](const std::string& levels) {
    return parse_profile_csv(header + levels, "s.csv", base(), 2300);
  };
  const auto profile = read("2350,765,-12,60\n3000,704,-15,50\n");
  ASSERT_TRUE(profile.ok()) << profile.status();
  EXPECT_EQ(profile->level.front().height_m, 2300);
  EXPECT_NEAR(profile->level.front().pressure_pa,
              76500 * std::exp(9.80665 * 28.9647e-3 * 50 / (8.314462618 * 261.15)), 1);
  EXPECT_TRUE(profile_above(*profile, 2300).ok());
  EXPECT_THAT(std::string(read("2401,760,-12,60\n3000,704,-15,50\n").status().message()),
              HasSubstr("s.csv:2:1: 2401: the lowest level is above 2400 m"));
  EXPECT_THAT(std::string(read("0,1015,5,60\n900,910,0,50\n").status().message()),
              HasSubstr("s.csv:3:1: the highest level, 900 m, is not above the place at 2300 m"));
}

TEST(AtmosphereProfile, RadiosondeInEveryUnit) {
  const AirLevel level = air_at(base(), 0);
  const double e_pa = 0.6 * saturation_pressure_pa(293.15);
  const double ppmv = 1e6 * e_pa / 100000, g_kg = 1e3 * 18.0153 / 28.9647 * e_pa / (1e5 - e_pa);
  const auto with = [&](const std::string& column, double value) {
    return "# a sounding\nheight_m, pressure_hpa, temperature_c, " + column + "\n0, 1000, 20, " +
           std::to_string(value) + "\n1500, 840, 12, 0\n9000, 310, -42, 0\n";
  };
  for (const auto& [column, value] :
       {std::pair<std::string, double>{"relative_humidity_percent", 60},
        {"h2o_ppmv", ppmv},
        {"h2o_g_kg", g_kg}}) {
    const auto profile = parse_profile_csv(with(column, value), "sonde.csv", base());
    ASSERT_TRUE(profile.ok()) << profile.status();
    EXPECT_NEAR(profile->level[0].gas.h2o_ppmv, ppmv, 1e-4 * ppmv) << column;
    EXPECT_EQ(profile->level[0].gas.ch4_ppmv, level.gas.ch4_ppmv);
    EXPECT_TRUE(check_profile(*profile).ok()) << check_profile(*profile);
    EXPECT_EQ(profile->level.back().height_m, 120e3);
    // The base's pressures join the last level's.
    EXPECT_NEAR(air_at(*profile, 9000).pressure_pa, 31000, 1e-6);
    EXPECT_GT(air_at(*profile, 9500).pressure_pa, 27000);
  }
  const auto dew = parse_profile_csv(
      "height_km,pressure_pa,temperature_k,dew_point_c\n0,100000,293.15,12.0\n2,80000,280,1\n",
      "sonde.csv", base());
  ASSERT_TRUE(dew.ok()) << dew.status();
  EXPECT_NEAR(relative_humidity_percent(dew->level[0]), 60, 0.3);
}

TEST(AtmosphereProfile, AnInversionIsKept) {
  const auto profile = parse_profile_csv(
      "height_m,pressure_hpa,temperature_c,relative_humidity_percent\n0,1015,10,80\n200,991,8,85\n"
      "300,979,14,40\n3000,705,-2,30\n",
      "sonde.csv", base());
  ASSERT_TRUE(profile.ok());
  EXPECT_NEAR(air_at(*profile, 300).temperature_k, 287.15, 1e-9);
  const auto bent = bend_to_surface(*profile, {284.15, 75, 101500});
  ASSERT_TRUE(bent.ok());
  EXPECT_NEAR(air_at(*bent, 300).temperature_k, 287.15 + 0.85, 1e-9);
  EXPECT_TRUE(Atmosphere::make({*bent, {}}).ok());
}

TEST(AtmosphereProfile, ErrorsNameThePlaceAndAllAreReported) {
  const auto bad = parse_profile_csv(
      "height_m,pressure_hpa,temperature_c,relative_humidity_percent\n0,1015,10,80\n200,1020,8,x\n"
      "150,979,99,40\n300,940,5,130\n400,930\n",
      "sonde.csv", base());
  ASSERT_FALSE(bad.ok());
  const std::string message(bad.status().message());
  EXPECT_THAT(message, HasSubstr("sonde.csv:3:12: \"x\" is not a number"));
  EXPECT_THAT(message, HasSubstr("sonde.csv:4:9: 99: expected 150 to 340 K"));
  EXPECT_THAT(message, HasSubstr("sonde.csv:5:11: 130: more water vapour than saturates the air"));
  EXPECT_THAT(message, HasSubstr("sonde.csv:6:1: 2 fields, expected 4"));
  EXPECT_THAT(
      std::string(parse_profile_csv("height_m,pressure\n", "s.csv", base()).status().message()),
      HasSubstr("s.csv:1:10: unknown column \"pressure\""));
  EXPECT_FALSE(parse_profile_csv("", "s.csv", base()).ok());
  const auto high = parse_profile_csv(
      "height_m,pressure_hpa,temperature_c,relative_humidity_percent\n500,955,5,50\n900,900,4,50\n",
      "s.csv", base());
  EXPECT_THAT(std::string(high.status().message()), HasSubstr("s.csv:2:1"));
  // Above 20 km, where saturation is no limit, and numbers that a change of unit makes infinite.
  const auto wet = parse_profile_csv(
      "height_km,pressure_hpa,temperature_k,h2o_ppmv\n0,1015,280,9000\n30,12,226,1e308\n", "s.csv",
      base());
  EXPECT_THAT(std::string(wet.status().message()), HasSubstr("s.csv:3:11: 1e308: expected"));
  for (const char* row : {"1e308,12,226,4", "30,1e308,226,4", "30,12,1e999,4", "0x1e,12,226,4"})
    EXPECT_FALSE(
        parse_profile_csv(
            absl::StrCat("height_km,pressure_hpa,temperature_k,h2o_ppmv\n0,1015,280,9000\n", row,
                         "\n"),
            "s.csv", base())
            .ok())
        << row;
}

TEST(AtmosphereProfile, DefaultsFollowLatitudeAndMonth) {
  EXPECT_EQ(default_afgl_profile(25, 12), AfglProfile::kTropical);
  EXPECT_EQ(default_afgl_profile(45, 7), AfglProfile::kMidlatitudeSummer);
  EXPECT_EQ(default_afgl_profile(45, 12), AfglProfile::kMidlatitudeWinter);
  EXPECT_EQ(default_afgl_profile(-45, 12), AfglProfile::kMidlatitudeSummer);
  EXPECT_EQ(default_afgl_profile(70, 1), AfglProfile::kSubarcticWinter);
  EXPECT_EQ(default_afgl_profile(-70, 1), AfglProfile::kSubarcticSummer);
}

TEST(AtmosphereSpecification, RefusesWhatItCannotMean) {
  AtmosphereSpec spec{base(), {}};
  EXPECT_TRUE(Atmosphere::make(spec).ok());
  spec.aerosol.kind = AerosolKind::kRural;
  EXPECT_THAT(std::string(Atmosphere::make(spec).status().message()), HasSubstr("visibility_m"));
  spec.aerosol.kind = AerosolKind::kNavyMaritime;
  EXPECT_TRUE(Atmosphere::make(spec).ok());
  spec.aerosol.wind_speed_m_s = 25;
  EXPECT_FALSE(Atmosphere::make(spec).ok());
  spec.aerosol = {};
  spec.co2_ppmv = -1;
  EXPECT_FALSE(Atmosphere::make(spec).ok());
  spec.co2_ppmv = 425;
  spec.profile.level[3].pressure_pa = 2e5;
  EXPECT_FALSE(Atmosphere::make(spec).ok());
  EXPECT_EQ(air_band(2.9).status().code(), absl::StatusCode::kOutOfRange);
  EXPECT_EQ(air_band(15.5).status().code(), absl::StatusCode::kOutOfRange);
  EXPECT_EQ(*air_band(10.0), 35U);
}

}  // namespace
}  // namespace irsig
