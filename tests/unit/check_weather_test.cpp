// The embedded atmosphere in a sweep file: what is resolved, and what the consistency gate calls
// wrong or odd.
#include "jobs/consistency/check_weather.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "core/thermal/condensation.h"
#include "jobs/resolve_sweep.h"
#include "messages/environment/weather_from_message.h"
#include "messages/inputs/moved_sweep.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// A sweep that nothing is wrong with; tests replace one piece.
struct Pieces {
  std::string time = "[\"12:00Z\"]";
  std::string place = "latitude_deg = 50\nlongitude_deg = 0\nheading_deg = 0\n";
  std::string part_k = "285";
  std::string name = "summer";
  std::string date = "2025-07-01";
  std::string season =
      "air_temperature_k = 290\nrelative_humidity_percent = 70\npressure_pa = 101300\n"
      "wind_speed_m_s = 5\n";
  std::string band = "lambda_min_um = 8\nlambda_max_um = 12\n";
  std::string elevations = "[10]";
  std::string range_m = "5000";
  std::string surroundings = "kind = \"sea\"\nsea_temperature_k = 288\n";
  std::string air = "aerosol = \"maritime\"\nvisibility_m = 23000\n";
  std::string sun = "false";
};

std::string text_of(const Pieces& p) {
  return "time = " + p.time +
         "\n[model]\ngenerate = \"sphere\"\ntriangles = 100\n[[part]]\nname = \"sphere\"\n"
         "material = \"hull\"\ntemperature_k = " +
         p.part_k + (p.place.empty() ? "\n" : "\n[place]\n") + p.place + "[[season]]\nname = \"" +
         p.name + "\"\ndate = " + p.date + "\n" + p.season + "[[band]]\nname = \"b\"\n" + p.band +
         "step_um = 0.1\n[viewpoints]\nkind = \"ring\"\ncount = 1\nrange_m = " + p.range_m +
         "\nelevation_deg = " + p.elevations + "\n[surroundings]\n" + p.surroundings +
         "[air]\nmodel = \"atmosphere\"\n" + p.air + "[transport]\nsun = " + p.sun + "\n";
}

// Resolves; files named in the sweep have this content.
absl::StatusOr<schema::ResolvedSweep> resolve(const Pieces& pieces,
                                              const std::string& content = "") {
  absl::StatusOr<SweepFile> file = parse_sweep(text_of(pieces), "s.toml");
  if (!file.ok()) return file.status();
  const auto read = [&](const std::string&) -> absl::StatusOr<std::string> { return content; };
  if (const absl::Status status = read_weather_files(*file, read); !status.ok()) return status;
  return resolve_sweep(*file, "");
}

std::string error_of(const Pieces& pieces, const std::string& content = "") {
  const auto sweep = resolve(pieces, content);
  return sweep.ok() ? "" : std::string(sweep.status().message());
}

std::vector<std::string> warnings_of(const Pieces& pieces) {
  const auto sweep = resolve(pieces);
  EXPECT_TRUE(sweep.ok()) << sweep.status();
  if (!sweep.ok()) return {};
  const auto& warnings = sweep->condition(0).warning();
  return {warnings.begin(), warnings.end()};
}

TEST(CheckWeather, NothingIsWrongWithThePieces) {
  EXPECT_EQ(error_of({}), "");
  EXPECT_THAT(warnings_of({}), IsEmpty());
}

TEST(ResolveAtmosphere, WritesTheWeatherOut) {
  const auto sweep = resolve({});
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  const schema::Condition& condition = sweep->condition(0);
  const schema::Weather& weather = condition.weather();
  EXPECT_EQ(weather.profile(), "midlatitude_summer");
  EXPECT_TRUE(weather.surface_stated());
  EXPECT_EQ(weather.air_temperature_k(), 290);
  EXPECT_EQ(weather.relative_humidity_percent(), 70);
  EXPECT_EQ(weather.aerosol(), "maritime");
  EXPECT_EQ(weather.visibility_m(), 23000);
  EXPECT_EQ(weather.co2_ppmv(), 425);
  EXPECT_TRUE(weather.refraction());
  EXPECT_TRUE(weather.summer_troposphere());
  EXPECT_EQ(weather.wind_speed_m_s(), 5);
  EXPECT_EQ(condition.surroundings().sea_model(), "cox_munk");
  EXPECT_EQ(condition.air_temperature_k(), 290);
  EXPECT_EQ(sweep->sweep().air().co2_ppmv(), 425);
}

// Expected: the air of the standard profile at the place's height; nothing of the sea's below it.
TEST(ResolveAtmosphere, TheProfileOfAHighPlaceBeginsThere) {
  Pieces high{.season = "wind_speed_m_s = 5\n"};
  high.place += "height_m = 2500\n";
  const auto sweep = resolve(high);
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  const schema::Weather& weather = sweep->condition(0).weather();
  EXPECT_EQ(weather.place_height_m(), 2500);
  const AirLevel there = air_at(afgl_profile(AfglProfile::kMidlatitudeSummer), 2500);
  EXPECT_NEAR(weather.pressure_pa(), there.pressure_pa, 1e-6);
  EXPECT_NEAR(weather.air_temperature_k(), there.temperature_k, 1e-9);
  const auto spec = weather_from_message(weather, sweep->condition(0).surroundings());
  ASSERT_TRUE(spec.ok()) << spec.status();
  EXPECT_EQ(spec->air.profile.level.front().height_m, 0);
  EXPECT_NEAR(air_at(spec->air.profile, 1000).pressure_pa,
              air_at(afgl_profile(AfglProfile::kMidlatitudeSummer), 3500).pressure_pa, 1e-6);
  high.place = "latitude_deg = 50\nlongitude_deg = 0\nheading_deg = 0\nheight_m = -20\n";
  EXPECT_EQ(resolve(high)->condition(0).weather().place_height_m(), 0);
}

// Rationale: what is not known of a cloud is an error of the model or of an input, never of both.
TEST(ResolveAtmosphere, WhatIsNotKnownOfACloudIsOneError) {
  Pieces cloudy;
  cloudy.season += "cloud_cover = 1\n";
  const auto spec_of = [&](const std::string& uncertainty) {
    Pieces p = cloudy;
    p.sun += uncertainty;
    const auto sweep = resolve(p);
    EXPECT_TRUE(sweep.ok()) << sweep.status();
    return weather_from_message(sweep->condition(0).weather(), sweep->condition(0).surroundings())
        .value();
  };
  const WeatherSpec none = spec_of("");
  EXPECT_TRUE(none.cloud_base_range_m.has_value());
  EXPECT_TRUE(none.cloud_water_range.has_value());
  const WeatherSpec water = spec_of("\n[uncertainty]\ncloud_water_path_relative = 0.3\n");
  EXPECT_TRUE(water.cloud_base_range_m.has_value());
  EXPECT_FALSE(water.cloud_water_range.has_value());
  const WeatherSpec base = spec_of("\n[uncertainty]\ncloud_base_m = 200\n");
  EXPECT_FALSE(base.cloud_base_range_m.has_value());
  EXPECT_TRUE(base.cloud_water_range.has_value());
  EXPECT_EQ(base.cloud->base_k, none.cloud->base_k);
}

// A base of risen air that is moved is one of air that has risen as far.
TEST(ResolveAtmosphere, AMovedBaseHasTheTemperatureOfRisenAir) {
  Pieces cloudy;
  cloudy.season += "cloud_cover = 1\n";
  const auto sweep = resolve(cloudy);
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  const MovedSweep moved = moved_sweep(*sweep, {"cloud_base_m", 150}, 1);
  const schema::Condition& c = moved.sweep.condition(0);
  const auto spec = weather_from_message(c.weather(), c.surroundings());
  ASSERT_TRUE(spec.ok()) << spec.status();
  EXPECT_NEAR(spec->cloud->base_m, sweep->condition(0).weather().cloud().base_m() + 150, 1e-9);
  ASSERT_TRUE(spec->cloud->base_k.has_value());
  EXPECT_NEAR(*spec->cloud->base_k, risen_air_k(290, 70, 101300, spec->cloud->base_m), 1e-9);
}

// Rationale: what nobody stated must follow from date and place, and say so.
// Expected: the mid-latitude winter of AFGL, 272.2 K and 1018 hPa at its surface.
// Source: AFGL-TR-86-0110, Table 1c.
TEST(ResolveAtmosphere, TheProfileFollowsFromDateAndLatitude) {
  Pieces winter{.name = "winter", .date = "2025-01-10", .season = "wind_speed_m_s = 3\n"};
  winter.surroundings = "kind = \"sea\"\nsea_temperature_k = 280\n";
  const auto sweep = resolve(winter);
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  const schema::Weather& weather = sweep->condition(0).weather();
  EXPECT_EQ(weather.profile(), "midlatitude_winter");
  EXPECT_FALSE(weather.surface_stated());
  EXPECT_FALSE(weather.summer_troposphere());
  EXPECT_NEAR(weather.air_temperature_k(), 272.2, 1e-9);
  EXPECT_NEAR(weather.pressure_pa(), 101800, 1e-6);
  EXPECT_NEAR(weather.relative_humidity_percent(), 77, 1);
  Pieces south = winter;
  south.place = "latitude_deg = -50\nlongitude_deg = 0\nheading_deg = 0\n";
  south.name = "any";
  EXPECT_EQ(resolve(south)->condition(0).weather().profile(), "midlatitude_summer");
  Pieces nowhere = winter;
  nowhere.place = "";
  EXPECT_THAT(error_of(nowhere), HasSubstr("place.latitude_deg is missing, expected it or "
                                           "air.profile"));
}

TEST(ResolveAtmosphere, TheNavysAerosolHasItsDefaults) {
  const auto sweep = resolve({.air = "aerosol = \"navy_maritime\"\n"});
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  const schema::Weather& weather = sweep->condition(0).weather();
  EXPECT_EQ(weather.air_mass(), 3);
  EXPECT_EQ(weather.wind_speed_24h_m_s(), 5);
  EXPECT_EQ(weather.visibility_m(), 0);
  EXPECT_EQ(sweep->sweep().air().air_mass(), 3);
}

// Rationale: the slopes of waves and the Navy's aerosol are known to 20 m/s; gusts are in weather
// files, and on land nobody asks for waves. Expected: at sea a warning, on land nothing, with the
// Navy's aerosol an error.
TEST(CheckWeather, StormsAreLimitedWhereTheirModelIs) {
  Pieces sea;
  sea.season =
      "air_temperature_k = 290\nrelative_humidity_percent = 70\npressure_pa = 101300\n"
      "wind_speed_m_s = 24\n";
  EXPECT_EQ(error_of(sea), "");
  EXPECT_THAT(warnings_of(sea), ElementsAre(AllOf(HasSubstr("season[0].wind_speed_m_s = 24"),
                                                  HasSubstr("known up to 20 m/s"))));
  Pieces navy = sea;
  navy.air = "aerosol = \"navy_maritime\"\n";
  EXPECT_THAT(error_of(navy), HasSubstr("season[0].wind_speed_m_s = 24: air.aerosol = "
                                        "\"navy_maritime\" holds from 0 to 20 m/s"));
  Pieces grey = sea;
  grey.surroundings += "sea_model = \"grey\"\nsea_emissivity = 0.96\n";
  grey.season =
      "day = { air_temperature_min_k = 285, air_temperature_max_k = 293, dew_point_k = 283 }\n"
      "pressure_pa = 101300\nwind_speed_m_s = 24\n";
  EXPECT_EQ(error_of(grey), "");
  EXPECT_THAT(warnings_of(grey), IsEmpty());
}

constexpr const char* kSonde =
    "height_m, pressure_hpa, temperature_c, dew_point_c\n"
    "0, 1013, 20, 15\n1000, 900, 14, 10\n3000, 700, 2, -5\n";

TEST(ResolveAtmosphere, AProfileFilesTextBecomesPartOfTheSweep) {
  Pieces pieces{.season = "wind_speed_m_s = 5\n"};
  pieces.air += "profile_file = \"sonde.csv\"\n";
  const auto sweep = resolve(pieces, kSonde);
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  const schema::Weather& weather = sweep->condition(0).weather();
  EXPECT_EQ(weather.profile_csv(), kSonde);
  EXPECT_EQ(weather.profile_file_name(), "sonde.csv");
  EXPECT_FALSE(sweep->sweep().air().has_profile_file());
  EXPECT_NEAR(weather.air_temperature_k(), 293.15, 1e-9);
}

TEST(ResolveAtmosphere, WhatIsWrongInAProfileFileStandsInItsOwnLine) {
  Pieces pieces;
  pieces.air += "profile_file = \"sonde.csv\"\n";
  const std::string wet = "height_m, pressure_hpa, temperature_c, dew_point_c\n0, 1013, 20, 21\n";
  EXPECT_THAT(
      error_of(pieces, wet),
      HasSubstr("sonde.csv:2:14: 21: expected a dew point not above the air's temperature"));
  EXPECT_THAT(error_of(pieces, ""), HasSubstr("air.profile_file = \"sonde.csv\": is empty"));
}

// Rationale: each level of a file may be dry enough, and the air above it not, once its pressure is
// scaled to join.
// Expected: a subarctic winter has 55 % and 385 hPa at 7 km (AFGL-TR-86-0110); under 1011 hPa at 6
// km, where it has 447 hPa itself, that becomes 125 %.
TEST(CheckWeather, AProfileMustFitTheAirAbove) {
  Pieces pieces{.place = "latitude_deg = 60\nlongitude_deg = 0\nheading_deg = 0\n",
                .name = "winter",
                .date = "2025-01-10",
                .season = "wind_speed_m_s = 5\n"};
  pieces.air += "profile_file = \"sonde.csv\"\n";
  const std::string head = "height_m, pressure_hpa, temperature_c, relative_humidity_percent\n";
  EXPECT_EQ(error_of(pieces, head + "0, 1013, 10, 50\n3000, 700, -8, 50\n"), "");
  EXPECT_THAT(
      error_of(pieces, head + "0, 1013, 10, 50\n1000, 1012, 4, 50\n6000, 1011, -30, 50\n"),
      AllOf(HasSubstr("s.toml:"), HasSubstr("air.profile_file does not fit the air above: level")));
}

struct Refused {
  std::string what;
  Pieces pieces;
  std::string key, message;
};

// Each contradiction, at its key, with both values.
TEST(CheckWeather, ContradictionsAreErrors) {
  const std::string surface =
      "relative_humidity_percent = 70\nwind_speed_m_s = 5\n";  // air and pressure vary
  const std::vector<Refused> cases = {
      {"a summer profile in December",
       {.name = "winter",
        .date = "2025-12-21",
        .season = "profile = \"midlatitude_summer\"\nwind_speed_m_s = 5\n"},
       "season[0].profile",
       "= \"midlatitude_summer\" and season[0].date = 2025-12-21 at place.latitude_deg = 50 "
       "contradict each other: the date is in winter"},
      {"a winter profile in July",
       {.air = "aerosol = \"none\"\nprofile = \"subarctic_winter\"\n"},
       "air.profile",
       "contradict each other: the date is in summer"},
      {"a summer in December",
       {.date = "2025-12-21"},
       "season[0].name",
       "= \"summer\" and date = 2025-12-21 at place.latitude_deg = 50 contradict each other: "
       "summer lasts from June 1 to September 24 there"},
      {"a southern summer in July",
       {.place = "latitude_deg = -50\nlongitude_deg = 0\nheading_deg = 0\n"},
       "season[0].name",
       "summer lasts from December 1 to March 24 there"},
      {"humidity",
       {.season = "air_temperature_k = 290\nrelative_humidity_percent = 110\n"
                  "pressure_pa = 101300\nwind_speed_m_s = 5\n"},
       "season[0].relative_humidity_percent",
       "= 110 puts the dew point at 291.51 K, above air_temperature_k = 290, expected a number "
       "from 0 to 100"},
      {"ice",
       {.surroundings = "kind = \"sea\"\nsea_temperature_k = 270\n"},
       "surroundings.sea_temperature_k",
       "= 270 is ice"},
      {"hot sea",
       {.surroundings = "kind = \"sea\"\nsea_temperature_k = 310\n"},
       "surroundings.sea_temperature_k",
       "= 310 is warmer than any sea"},
      {"sea and air",
       {.season = "air_temperature_k = 250\npressure_pa = 101300\n" + surface,
        .surroundings = "kind = \"sea\"\nsea_temperature_k = 285\n"},
       "surroundings.sea_temperature_k",
       "= 285 and air_temperature_k = 250 in season \"summer\" differ by 35 K, expected at most "
       "30 K"},
      {"pressure",
       {.season = "air_temperature_k = 290\npressure_pa = 80000\n" + surface},
       "season[0].pressure_pa",
       "= 80000 and place.height_m = 0 contradict each other: the standard atmosphere has 101325 "
       "Pa there"},
      {"night at noon",
       {.name = "night"},
       "season[0].name",
       "= \"night\" contradicts time[0] = \"12:00Z\": the sun is then 63"},
      {"noon at night",
       {.time = "[\"00:00Z\"]", .name = "noon"},
       "season[0].name",
       "below the horizon"},
      {"ground",
       {.season = "air_temperature_k = 290\nrelative_humidity_percent = 70\n"
                  "pressure_pa = 101300\n",
        .surroundings = "kind = \"ground\"\nground_temperature_k = 400\nground_emissivity = 0.9\n"},
       "surroundings.ground_temperature_k",
       "= 400, expected 180 to 370 K"},
  };
  for (const Refused& c : cases) {
    const std::string error = error_of(c.pieces);
    EXPECT_THAT(error,
                AllOf(HasSubstr("s.toml:"), HasSubstr(": " + c.key + " "), HasSubstr(c.message)))
        << c.what;
    EXPECT_EQ(error.find('\n'), std::string::npos) << c.what << ": " << error;
  }
}

TEST(CheckWeather, OdditiesAreWarnings) {
  const std::string surface =
      "relative_humidity_percent = 70\npressure_pa = 101300\n"
      "wind_speed_m_s = 5\n";
  const std::vector<Refused> cases = {
      {"a summer a week early", {.date = "2025-05-25"}, "season[0].name", "are 7 days apart"},
      {"a tropical profile far north",
       {.place = "latitude_deg = 60\nlongitude_deg = 0\nheading_deg = 0\n",
        .air = "aerosol = \"none\"\nprofile = \"tropical\"\n"},
       "air.profile",
       "is far from place.latitude_deg = 60"},
      {"a summer profile in March",
       {.name = "any",
        .date = "2025-03-10",
        .air = "aerosol = \"none\"\nprofile = "
               "\"midlatitude_summer\"\n"},
       "air.profile",
       "near the other half of the year"},
      {"a sea 20 K from the air",
       {.season = "air_temperature_k = 300\n" + surface,
        .surroundings = "kind = \"sea\"\nsea_temperature_k = 280\n"},
       "surroundings.sea_temperature_k",
       "differ by 20 K"},
      {"a part 25 K colder than the air",
       {.part_k = "265"},
       "part[0].temperature_k",
       "= 265 is more than 20 K colder than air_temperature_k = 290"},
      {"a part colder than the sky",
       {.part_k = "150"},
       "part[0].temperature_k",
       "is colder than any sky above air_temperature_k = 290"},
      {"dry fog",
       {.air = "aerosol = \"radiation_fog\"\nvisibility_m = 500\n"},
       "air.aerosol",
       "fog needs 95 % or more"},
      {"fog by another name",
       {.air = "aerosol = \"rural\"\nvisibility_m = 500\n"},
       "air.visibility_m",
       "= 500 is fog, but air.aerosol = \"rural\""},
      {"low pressure",
       {.season = "air_temperature_k = 290\nrelative_humidity_percent = 70\n"
                  "pressure_pa = 94000\nwind_speed_m_s = 5\n"},
       "season[0].pressure_pa",
       "fit badly"},
      {"polar night",
       {.place = "latitude_deg = 80\nlongitude_deg = 0\nheading_deg = 0\n",
        .part_k = "272",
        .name = "winter",
        .date = "2025-12-21",
        .season = "wind_speed_m_s = 5\n",
        .surroundings = "kind = \"sea\"\nsea_temperature_k = 271.5\n",
        .sun = "true"},
       "season[0].date",
       "is polar night at place.latitude_deg = 80"},
      {"glitter at grazing angles",
       {.time = "[\"19:10Z\"]",
        .place = "latitude_deg = 40\nlongitude_deg = 0\nheading_deg = 0\n",
        .sun = "true"},
       "time[0]:",
       "its glitter lacks the shadows of waves"},
      {"a sun that never shines",
       {.time = "[\"00:00Z\", \"01:00Z\"]", .sun = "true"},
       "transport.sun",
       "below the horizon at every time of this sweep"},
  };
  for (const Refused& c : cases) {
    const std::vector<std::string> warnings = warnings_of(c.pieces);
    ASSERT_THAT(warnings, SizeIs(1)) << c.what;
    EXPECT_THAT(warnings[0], AllOf(::testing::StartsWith(c.key + " "), HasSubstr(c.message)))
        << c.what;
  }
}

TEST(CheckWeather, ASensorUnderWaterIsRefused) {
  Pieces below;
  below.elevations = "[-0.02]";  // 1.7 m below the tangent plane at 5 km, 0.2 m above the sea
  EXPECT_EQ(error_of(below), "");
  below.elevations = "[-0.05]";
  EXPECT_THAT(error_of(below), HasSubstr("lies under water"));
}

// One path in CSV, from the sensor of `Pieces` (10 deg above the horizon at 5 km, 871 m up) to a
// sphere's centre, taken at 1 m; 8 to 12 um.
std::string imported(double range_m, int day, double least_cm1) {
  std::string text = absl::StrCat(
      "# observer_height_m: 871.1\n# target_height_m: 1\n# range_m: ", range_m,
      "\n# day_of_year: ", day, "\nwavenumber_cm1, transmittance, radiance_w_m2_sr_um\n");
  for (double cm1 = least_cm1; cm1 <= 1260; cm1 += 5) absl::StrAppend(&text, cm1, ", 0.7, 2.5\n");
  return text;
}

TEST(CheckWeather, AnImportMustBeOfThisDayAndTheseLinesOfSight) {
  Pieces pieces;
  pieces.season += "modtran_file = \"july.csv\"\n";
  const auto sweep = resolve(pieces, imported(5000, 182, 820));
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  EXPECT_EQ(sweep->condition(0).weather().modtran_text(), imported(5000, 182, 820));
  EXPECT_EQ(sweep->condition(0).weather().modtran_file_name(), "july.csv");
  EXPECT_FALSE(sweep->sweep().season(0).has_modtran_file());

  EXPECT_THAT(error_of(pieces, imported(5000, 10, 820)),
              AllOf(HasSubstr("s.toml:20:1: season[0].modtran_file was not made for "
                              "2025-07-01T12:00:00Z: "),
                    HasSubstr("182"), HasSubstr("10")));
  EXPECT_THAT(error_of(pieces, imported(6000, 182, 820)),
              HasSubstr("season[0].modtran_file does not cover viewpoint 0 (azimuth 0, elevation "
                        "10, range 5000 m)"));
  EXPECT_THAT(error_of(pieces, imported(5000, 182, 900)),
              AllOf(HasSubstr("has no transmittance from "), HasSubstr("in band \"b\"")));
  EXPECT_THAT(error_of(pieces, "# range_m: x\n"), HasSubstr("july.csv:1:"));
}

// Without the embedded atmosphere skies and seas are stated as somebody likes them.
TEST(CheckWeather, OtherAirsMayHaveAnySea) {
  const auto sweep = resolved_text(
      "time = [\"12:00Z\"]\n[model]\ngenerate = \"sphere\"\ntriangles = 100\n[[part]]\nname = "
      "\"sphere\"\nmaterial = \"hull\"\ntemperature_k = 0\n[[season]]\nname = \"any\"\ndate = "
      "2025-07-01\n[[band]]\nname = \"b\"\nlambda_min_um = 8\nlambda_max_um = 12\nstep_um = 0.1\n"
      "[viewpoints]\nkind = \"ring\"\ncount = 1\nrange_m = 50\nelevation_deg = [1]\n"
      "[surroundings]\nkind = \"sea\"\nsky_temperature_k = 0\nsea_temperature_k = "
      "0\nsea_emissivity = 1\n[air]\nmodel = \"vacuum\"\n[transport]\nsun = false\n");
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  EXPECT_THAT(sweep->condition(0).warning(), IsEmpty());
}

}  // namespace
}  // namespace irsig
