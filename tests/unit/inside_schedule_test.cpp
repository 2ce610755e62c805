// Tests temperatures behind a wall over the day, from the sweep file to temperatures.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/geo/sun.h"
#include "jobs/keys/expand.h"
#include "messages/inputs/moved_sweep.h"
#include "runner/heat_field.h"
#include "runner/heat_weather.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

// A steel sheet in front of what `inside` says, eight hours behind Greenwich.
schema::ResolvedSweep inside_sweep(const std::string& inside, const std::string& times,
                                   const std::string& more = "") {
  const auto out = resolved_text("time = " + times + R"(
[model]
generate = "box"
triangles = 12
[place]
latitude_deg = 45
longitude_deg = -120
heading_deg = 0
[[material]]
name = "paint"
kind = "lambert"
emissivity = 0.9
solar_absorptance = 0.7
[[build_up]]
name = "wall"
layer = [{ solid = "steel", thickness_m = 0.001 }]
)" + inside + R"(
[[part]]
name = "box"
material = "paint"
build_up = "wall"
[heat]
step_minutes = 20
rays = 32
[weather]
pressure_pa = 101300
wind_speed_m_s = 6
wind_from_deg = 270
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
kind = "ground"
ground_temperature_k = 288
ground_emissivity = 0.95
solar_albedo = 0.2
[air]
model = "atmosphere"
aerosol = "rural"
visibility_m = 23000
[transport]
sun = true
)" + more);
  EXPECT_TRUE(out.ok()) << out.status();
  return out.ok() ? *out : schema::ResolvedSweep{};
}
const std::string kSteps = R"(inside = "temperature"
inside_between = "steps"
inside_schedule = [
  { time = "05:20-08:00", temperature_k = 340 },
  { time = "18:40-08:00", temperature_k = 290 },
])";
const std::string kLinear = R"(inside = "temperature"
inside_between = "linear"
inside_schedule = [
  { time = "05:00-08:00", temperature_k = 300 },
  { time = "11:00-08:00", temperature_k = 330 },
])";

std::vector<std::string> keys_of(const schema::ResolvedSweep& sweep) {
  std::vector<std::string> out;
  for (const schema::JobSpec& job : expand_jobs(sweep, 1)) out.push_back(job.job_key());
  return out;
}

// [time] mean over facets
std::vector<double> temperatures(const schema::ResolvedSweep& sweep) {
  const auto out = compute_heat(sweep, {}, 0);
  EXPECT_TRUE(out.ok()) << out.status();
  if (!out.ok()) return {};
  std::vector<double> mean;
  for (const schema::PartTemperature& row : out->part()) mean.push_back(row.mean_k());
  return mean;
}

TEST(InsideSchedule, IsResolvedToUtc) {
  const schema::ResolvedSweep s = inside_sweep(kSteps, R"(["12:00-08:00"])");
  const auto& schedule = s.sweep().build_up(0).inside_schedule();
  ASSERT_EQ(schedule.size(), 2);
  EXPECT_EQ(schedule[0].time(), "02:40:00Z");
  EXPECT_EQ(schedule[0].temperature_k(), 290);
  EXPECT_EQ(schedule[1].time(), "13:20:00Z");
  EXPECT_EQ(schedule[1].temperature_k(), 340);
}

// Another way to write the same schedule is the same work; another value, another time or another
// way between is not.
TEST(InsideSchedule, IsPartOfTheKeysOfItsJobs) {
  const std::string noon = R"(["12:00-08:00"])";
  const auto key = [&](const std::string& inside) { return keys_of(inside_sweep(inside, noon)); };
  const auto changed = [](std::string text, const std::string& from, const std::string& to) {
    EXPECT_NE(text.find(from), std::string::npos);
    return text.replace(text.find(from), from.size(), to);
  };
  const auto first = key(kSteps);
  EXPECT_EQ(first, key(R"(inside = "temperature"
inside_between = "steps"
inside_schedule = [
  { time = "02:40Z", temperature_k = 290 },
  { time = "13:20:00Z", temperature_k = 340 },
])"));
  for (const auto& [from, to] :
       {std::pair{"340", "341"}, {"05:20", "05:21"}, {"steps", "linear"}}) {
    const auto other = key(changed(kSteps, from, to));
    ASSERT_EQ(other.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NE(other[i], first[i]) << to;
  }
}

// Rationale: what happens between two positions of the sun is not to be missed.
// Expected: the schedule's times are knots, at which both computations stop.
TEST(InsideSchedule, ItsTimesAreKnots) {
  const schema::ResolvedSweep s = inside_sweep(kSteps, R"(["12:00-08:00"])");
  const auto knots = heat_weather(s.sweep(), s.heat(0));
  ASSERT_TRUE(knots.ok()) << knots.status();
  int found = 0;
  for (std::size_t k = 0; k < knots->knot_s.size(); ++k) {
    const double of_day = std::fmod(knots->knot_s[k], 86400);
    if (std::abs(of_day - 9600) < 1e-3 || std::abs(of_day - 48000) < 1e-3) {
      ++found;
      EXPECT_EQ(k % 2, 0U);
    }
  }
  EXPECT_EQ(found, 2);
}

// Rationale: a schedule in the wrong time zone is a plausible lie.
// Expected: a sheet of 1 mm has the temperature behind it, to 0.1 K: the face loses at most
// 1 kW/m2, through 1 mm of steel 0.02 K. Steps also a minute before and after.
TEST(InsideSchedule, AThinSheetIsAsWarmAsWhatIsBehindIt) {
  const auto steps = temperatures(inside_sweep(
      kSteps, R"(["00:00-08:00", "05:18-08:00", "05:22-08:00", "18:38-08:00", "18:42-08:00"])"));
  ASSERT_EQ(steps.size(), 5U);
  const double expected[] = {290, 290, 340, 340, 290};
  for (std::size_t t = 0; t < 5; ++t) EXPECT_NEAR(steps[t], expected[t], 0.1) << t;
  const auto linear = temperatures(
      inside_sweep(kLinear, R"(["02:00-08:00", "05:00-08:00", "08:30-08:00", "20:00-08:00"])"));
  ASSERT_EQ(linear.size(), 4U);
  // The line goes from 11 h to 5 h in 18 h: 20 h is half of the way, 2 h five sixths.
  const double between[] = {305, 300, 317.5, 315};
  for (std::size_t t = 0; t < 4; ++t) EXPECT_NEAR(linear[t], between[t], 0.1) << t;
}

// Expected: a sheet follows within minutes, so that by day it is as warm as with the same heat
// always, by night as with none.
TEST(InsideSchedule, MachineryIsOnByDay) {
  const std::string times = R"(["01:00-08:00", "12:00-08:00"])";
  const auto by_day = temperatures(inside_sweep(R"(inside = "heat_flux"
inside_between = "steps"
inside_schedule = [
  { time = "06:00-08:00", heat_flux_w_m2 = 200 }, { time = "18:00-08:00", heat_flux_w_m2 = 0 },
])",
                                                times)),
             always = temperatures(
                 inside_sweep("inside = \"heat_flux\"\ninside_heat_flux_w_m2 = 200", times)),
             never = temperatures(inside_sweep("inside = \"adiabatic\"", times));
  ASSERT_EQ(by_day.size(), 2U);
  EXPECT_NEAR(by_day[0], never[0], 0.03);
  EXPECT_NEAR(by_day[1], always[1], 0.03);
  EXPECT_GT(always[1] - never[1], 5);
}

TEST(InsideSchedule, MovesAsAWholeWithItsUncertainty) {
  const schema::ResolvedSweep s =
      inside_sweep(kSteps, R"(["12:00-08:00"])", "[uncertainty]\ninside_temperature_k = 3\n");
  ASSERT_EQ(s.heat_size(), 2) << "the temperatures, and what the input changes of them";
  const MovedSweep moved = moved_sweep(s, {"inside_temperature_k", 3}, 1);
  EXPECT_EQ(moved.values, 2);
  const auto& schedule = moved.sweep.sweep().build_up(0).inside_schedule();
  EXPECT_EQ(schedule[0].temperature_k(), 293);
  EXPECT_EQ(schedule[1].temperature_k(), 343);
  const auto changes = compute_heat(s, {}, 1);
  ASSERT_TRUE(changes.ok()) << changes.status();
  schema::HeatField field;
  ASSERT_TRUE(field.ParseFromString(changes->field()));
  ASSERT_EQ(field.change_k_size(), 1);
  float first = 0;
  std::memcpy(&first, field.change_k(0).data(), sizeof first);
  EXPECT_NEAR(first, 3, 0.02);
}

}  // namespace
}  // namespace irsig
