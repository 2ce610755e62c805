// The weather of a heat run at the knots of its computation.
#include "runner/heat_weather.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/geo/sun.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

// A box in a day's weather; `more` replaces lines of [place] and the surroundings.
schema::ResolvedSweep sweep(
    const std::string& times, const std::string& place = "heading_deg = 0",
    const std::string& surroundings = R"(kind = "sea"
sea_temperature_k = 288)",
    const std::string& weather = "wind_speed_m_s = 6\nwind_from_deg = 270") {
  const auto out = resolved_text("time = " + times + R"(
[model]
generate = "box"
triangles = 12
[place]
latitude_deg = 45
longitude_deg = 0
)" + place + R"(
[[material]]
name = "paint"
kind = "lambert"
emissivity = 0.9
solar_absorptance = 0.7
[[build_up]]
name = "wall"
layer = [{ solid = "steel", thickness_m = 0.01 }]
inside = "adiabatic"
[[part]]
name = "box"
material = "paint"
build_up = "wall"
[heat]
step_minutes = 20
[weather]
pressure_pa = 101300
)" + weather + R"(
[[season]]
name = "a"
date = 2025-06-21
day = { air_temperature_min_k = 285, air_temperature_max_k = 295, dew_point_k = 280 }
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.5
[viewpoints]
kind = "list"
range_m = 1000
aspect = [ { azimuth_deg = 30, elevation_deg = 20 } ]
[surroundings]
)" + surroundings + R"(
[air]
model = "atmosphere"
aerosol = "maritime"
visibility_m = 23000
[transport]
sun = true
)");
  EXPECT_TRUE(out.ok()) << out.status();
  return out.ok() ? *out : schema::ResolvedSweep{};
}
HeatKnots knots(const schema::ResolvedSweep& sweep) {
  const auto out = heat_weather(sweep.sweep(), sweep.heat(0));
  EXPECT_TRUE(out.ok()) << out.status();
  return out.ok() ? *out : HeatKnots{};
}

TEST(HeatWeather, KnotsMeetTheTimesAndTheSunAndGoInPairs) {
  const schema::ResolvedSweep of = sweep(R"(["12:00Z", "03:07Z", "12:00:01Z"])");
  const HeatKnots k = knots(of);
  ASSERT_EQ(k.knot_s.size() % 2, 1U);
  ASSERT_EQ(k.at.size(), k.knot_s.size());
  EXPECT_EQ(k.day_knots, k.knot_s.size() - 1);
  EXPECT_NEAR(k.knot_s.back() - k.knot_s.front(), 86400, 1e-6);
  for (std::size_t i = 1; i < k.knot_s.size(); ++i) {
    EXPECT_GT(k.knot_s[i], k.knot_s[i - 1]);
    EXPECT_LE(k.knot_s[i] - k.knot_s[i - 1], 1200 + 1e-6);
  }
  // The times wanted, increasing, at even knots.
  ASSERT_EQ(of.heat(0).time_utc_size(), 3);
  for (int t = 0; t < 3; ++t) {
    const std::size_t at = k.output_knot[k.output_of_time[static_cast<std::size_t>(t)]];
    EXPECT_EQ(at % 2, 0U);
    EXPECT_NEAR(k.knot_s[at], unix_seconds(*parse_rfc3339(of.heat(0).time_utc(t))), 1e-6);
  }
  // At sunrise light begins, and ends at sunset: at knots, of which one side is dark.
  int edges = 0;
  for (const HeatWeather& w : k.at)
    edges += (w.before.direct_normal_w_m2 > 0) != (w.after.direct_normal_w_m2 > 0) ||
                     (std::abs(w.sun.z) < 1e-3)
                 ? 1
                 : 0;
  EXPECT_GE(edges, 2);
}

// Rationale: of instants every 10 minutes under broken cloud the second computation saw every other
// one: 13 K stated of 0.27 K. Expected: what bends is at even knots, which both computations have;
// a smooth day has no more knots for it.
TEST(HeatWeather, RecordsThatBendAreAtKnotsOfBothComputations) {
  schema::ResolvedSweep of = sweep(R"(["12:00Z"])");
  of.mutable_sweep()->mutable_heat()->set_step_minutes(10);
  schema::HeatRun& run = *of.mutable_heat(0);
  const double begin_s = run.course().record(0).unix_s();
  const std::size_t smooth = knots(of).knot_s.size();
  schema::WeatherCourse course;
  course.set_periodic(true);
  for (int i = 0; i <= 144; ++i) {
    schema::WeatherRecord& r = *course.add_record();
    r = run.course().record(0);
    r.set_unix_s(begin_s + 600 * i);
    const bool cloud = i % 144 > 60 && i % 144 < 90 && i % 2 == 0;
    r.set_direct_normal_w_m2(cloud ? 0 : 700);
    r.set_diffuse_horizontal_w_m2(100);
    r.set_sky_w_m2(320);
  }
  *run.mutable_course() = course;
  const HeatKnots k = knots(of);
  for (int i = 61; i <= 89; ++i) {
    const auto at = std::find_if(k.knot_s.begin(), k.knot_s.end(),
                                 [&](double t) { return std::abs(t - begin_s - 600 * i) < 1; });
    ASSERT_NE(at, k.knot_s.end()) << i;
    EXPECT_EQ((at - k.knot_s.begin()) % 2, 0) << i;
  }
  EXPECT_LE(k.knot_s.size(), smooth + 2 * 33);
}

// Rationale: a ship that runs before the wind feels less of it.
// Expected: true wind less the target's own velocity, where it comes from in the target's frame (x
// forward, y to starboard).
TEST(HeatWeather, TheWindIsTheOneThatTheTargetFeels) {
  const auto felt = [](const std::string& place) {
    return knots(sweep(R"(["12:00Z"])", place)).at.front();
  };
  const HeatWeather still = felt("heading_deg = 0");  // wind from the west: from port
  EXPECT_NEAR(still.wind_m_s, 6, 1e-9);
  EXPECT_NEAR(still.wind_from.y, -1, 1e-9);
  const HeatWeather before = felt("heading_deg = 90\nspeed_m_s = 4");  // east, before it
  EXPECT_NEAR(before.wind_m_s, 2, 1e-9);
  EXPECT_NEAR(before.wind_from.x, -1, 1e-9);
  const HeatWeather against = felt("heading_deg = 270\nspeed_m_s = 4");
  EXPECT_NEAR(against.wind_m_s, 10, 1e-9);
  EXPECT_NEAR(against.wind_from.x, 1, 1e-9);
  const HeatWeather across = felt("heading_deg = 0\nspeed_m_s = 8");
  EXPECT_NEAR(across.wind_m_s, 10, 1e-9);
  EXPECT_NEAR(across.wind_from.x, 0.8, 1e-9);
  EXPECT_NEAR(across.wind_from.y, -0.6, 1e-9);
  EXPECT_NEAR(felt("heading_deg = 90\nspeed_m_s = 6").wind_m_s, 0, 1e-9);
}

TEST(HeatWeather, SeaAndGroundAreWhatTheSweepSays) {
  const HeatKnots sea = knots(sweep(R"(["12:00Z"])", "heading_deg = 0\nspeed_m_s = 3"));
  EXPECT_TRUE(sea.beneath.water);
  EXPECT_EQ(sea.beneath.temperature_k, 288);
  EXPECT_EQ(sea.beneath.flow_m_s, 3);
  EXPECT_EQ(sea.beneath.solar_albedo, 0.06);
  // Water's hemispherical emissivity: 0.91 to 0.95 in the literature.
  EXPECT_GT(sea.beneath.emissivity, 0.9);
  EXPECT_LT(sea.beneath.emissivity, 0.96);
  const HeatKnots ground = knots(sweep(R"(["12:00Z"])", "heading_deg = 0",
                                       "kind = \"ground\"\nground_temperature_k = 290\n"
                                       "ground_emissivity = 0.93\nsolar_albedo = 0.3"));
  EXPECT_FALSE(ground.beneath.water);
  EXPECT_EQ(ground.beneath.temperature_k, 290);
  EXPECT_EQ(ground.beneath.emissivity, 0.93);
  EXPECT_EQ(ground.beneath.solar_albedo, 0.3);
}

// Rationale: the sun's light at noon of a clear summer day is known to everybody.
TEST(HeatWeather, NoonIsBrightAndCloudsAreNot) {
  const auto brightest = [](const std::string& more) {
    double direct = 0, diffuse = 0;
    for (const HeatWeather& w :
         knots(sweep(R"(["12:00Z"])", "heading_deg = 0", "kind = \"sea\"\nsea_temperature_k = 288",
                     "wind_speed_m_s = 6\nwind_from_deg = 270" + more))
             .at) {
      direct = std::max(direct, w.after.direct_normal_w_m2);
      diffuse = std::max(diffuse, w.after.diffuse_horizontal_w_m2);
    }
    return std::pair{direct, diffuse};
  };
  const auto [direct, diffuse] = brightest("");
  EXPECT_GT(direct, 750);
  EXPECT_LT(direct, 950);
  EXPECT_GT(diffuse, 70);
  EXPECT_LT(diffuse, 200);
  const auto [covered, cloudy] = brightest("\ncloud_cover = 1");
  EXPECT_EQ(covered, 0);
  EXPECT_GT(cloudy, diffuse);
  // A layer of known water: 6.4 g/m2 of crystals of 64 um have the optical depth 0.15, and the sun
  // stands 68.4 deg high.
  const auto [thin, hazy] =
      brightest("\ncloud_cover = 1\ncloud_type = \"cirrus\"\ncloud_water_path_g_m2 = 6.4");
  EXPECT_NEAR(thin / direct, std::exp(-0.15 / std::sin(68.4 * M_PI / 180)), 0.002);
  EXPECT_GT(hazy, diffuse);
  // [kasten1980] is of covers of water: thin ice lets the same sun through to walls as to rows.
  const auto [of_type, haze] = brightest("\ncloud_cover = 1\ncloud_type = \"cirrus\"");
  EXPECT_NEAR(of_type / direct, std::exp(-0.157 / std::sin(68.4 * M_PI / 180)), 0.002);
  EXPECT_GT(haze, diffuse);
}

}  // namespace
}  // namespace irsig
