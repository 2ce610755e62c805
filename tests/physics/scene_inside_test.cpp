// Walls whose inner side changes over the day.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/base/constants.h"
#include "core/thermal/scene/scene_heat.h"
#include "heat_scene.h"

namespace irsig {
namespace {

constexpr double kDayS = 86400, kHourS = 3600;

// Returns a day of constant weather, with knots every 10 minutes and outputs every hour.
SceneHeatRequest day_of(const HeatWeather& weather) {
  SceneHeatRequest r;
  for (int k = 0; k <= 144; ++k) {
    r.knot_s.push_back(kDayS * k / 144);
    r.weather.push_back(weather);
    if (k % 6 == 0 && k < 144) r.output_knot.push_back(static_cast<std::size_t>(k));
  }
  r.day_knots = 144;
  r.tolerance_k = 1e-3;
  return r;
}
// Below ground, white to heat: nothing goes through the outer face.
SceneHeatRequest buried(const std::vector<Layer>& layers, InnerSide side) {
  SceneHeatRequest r = day_of({290, 0, {1, 0, 0}, {0, 0, 1}, 0.0047, {0, 0, 300}, {0, 0, 300}});
  r.beneath = {.water = false, .surface_z_m = -1000, .temperature_k = 250};
  r.part = {{0, 0, 0u, 0}};
  r.build_up.emplace_back();
  r.build_up[0].name = "wall";
  r.build_up[0].layers = layers;
  r.build_up[0].inner_side = side;
  return r;
}
Target disk() { return target_of(generated("disk", 8), {part("disk")}); }

// Fourier's coefficients of a schedule, exactly: by its jumps, or by the jumps of its slope.
std::complex<double> coefficient(const DaySchedule& s, int n) {
  const std::complex<double> i(0, 1);
  const double omega = 2 * std::numbers::pi * n / kDayS;
  const std::size_t count = s.at.size();
  std::complex<double> sum = 0;
  for (std::size_t j = 0; j < count; ++j) {
    const auto &before = s.at[(j + count - 1) % count], &here = s.at[j],
               &after = s.at[(j + 1) % count];
    const auto apart = [](double from_s, double to_s) {
      return to_s > from_s ? to_s - from_s : to_s - from_s + kDayS;
    };
    const std::complex<double> turn = std::exp(-i * omega * here.utc_s);
    if (s.steps)
      sum += (here.value - before.value) * turn / (i * omega * kDayS);
    else
      sum += ((after.value - here.value) / apart(here.utc_s, after.utc_s) -
              (here.value - before.value) / apart(before.utc_s, here.utc_s)) *
             turn / (-omega * omega * kDayS);
  }
  return sum;
}
double mean_of(const DaySchedule& s) {
  double sum = 0;
  for (std::size_t j = 0; j < s.at.size(); ++j) {
    const bool last = j + 1 == s.at.size();
    const auto& next = s.at[last ? 0 : j + 1];
    const double length_s = next.utc_s - s.at[j].utc_s + (last ? kDayS : 0);
    sum += length_s * (s.steps ? s.at[j].value : 0.5 * (s.at[j].value + next.value));
  }
  return sum / kDayS;
}

// Rationale: what is behind a wall changes over the day, and the wall answers late and weakly.
// Expected: of each wave of the inner temperature, its outer face has 1 / cosh((1 + i) depth /
// root(2 diffusivity / omega)) where that face is adiabatic; 2 mK where the wall swings by 20 K.
// Source: the heat equation, solved by hand; Fourier's series of the schedule, exact.
TEST(SceneInside, ASlabAnswersEveryWaveOfItsSchedule) {
  const Layer concrete{0.12, 1.4, 2300, 880};
  const double diffusivity = 1.4 / (2300 * 880);
  for (const bool steps : {false, true}) {
    const DaySchedule schedule{
        {{0, 290}, {6 * kHourS, 330}, {14 * kHourS, 320}, {20 * kHourS, 295}}, steps};
    SceneHeatRequest r = buried({concrete}, InnerSide::kFixedTemperature);
    r.build_up[0].inner_at = at_knots(schedule, r.knot_s);
    const auto result = solve_scene_heat(disk(), r);
    ASSERT_TRUE(result.ok()) << result.status();
    double low = 1e9, high = 0;
    for (std::size_t o = 0; o < r.output_knot.size(); ++o) {
      const double t = r.knot_s[r.output_knot[o]];
      double expected = mean_of(schedule);
      for (int n = 1; n <= 400; ++n) {
        const std::complex<double> i(0, 1);
        const double omega = 2 * std::numbers::pi * n / kDayS;
        const std::complex<double> wave = std::sqrt(i * omega / diffusivity) * 0.12;
        expected +=
            2 * (coefficient(schedule, n) / std::cosh(wave) * std::exp(i * omega * t)).real();
      }
      low = std::min(low, expected);
      high = std::max(high, expected);
      for (std::size_t f = 0; f < result->kelvin[o].size(); ++f) {
        const double off = std::abs(static_cast<double>(result->kelvin[o][f]) - expected);
        EXPECT_LT(off, 2e-3) << steps << " " << t / kHourS << " h";
        EXPECT_LE(off, static_cast<double>(result->error_k[o][f]));
        EXPECT_LT(result->error_k[o][f], 3e-3) << "both computations have the same schedule";
      }
    }
    EXPECT_GT(high - low, 15) << "the wall feels it";
    EXPECT_LT(result->closure_w_m2, 1e-6);
  }
}

// Returns, after many days, the temperature of a plate that is as warm throughout and goes under
// two values, each from a time on. rate_s: of its approach.
double approached(double t, double on_s, double off_s, double on, double off, double rate_s) {
  // Periodic: what is left of a day's approach is the same every day.
  const double up_s = off_s - on_s, down_s = kDayS - up_s, a = std::exp(-up_s / rate_s),
               b = std::exp(-down_s / rate_s),
               at_on = (off * (1 - b) + on * (1 - a) * b) / (1 - a * b),
               at_off = on + (at_on - on) * a;
  if (t >= on_s && t < off_s) return on + (at_on - on) * std::exp(-(t - on_s) / rate_s);
  const double since_s = t >= off_s ? t - off_s : t + kDayS - off_s;
  return off + (at_off - off) * std::exp(-since_s / rate_s);
}

// Expected: a thin plate comes near its room's air as exp(-t h / capacity). 1 mK of 25 K.
TEST(SceneInside, AThinPlateApproachesTheAirOfItsRoom) {
  SceneHeatRequest r = buried({{0.006, 1e6, 7850, 490}}, InnerSide::kAir);
  const DaySchedule schedule{{{6 * kHourS, 315}, {15 * kHourS, 290}}, true};
  r.build_up[0].inner_h_w_m2_k = 3;
  r.build_up[0].inner_at = at_knots(schedule, r.knot_s);
  const auto result = solve_scene_heat(disk(), r);
  ASSERT_TRUE(result.ok()) << result.status();
  const double rate_s = 0.006 * 7850 * 490 / 3;
  for (std::size_t o = 0; o < r.output_knot.size(); ++o)
    for (std::size_t f = 0; f < result->kelvin[o].size(); ++f) {
      const double off = std::abs(
          static_cast<double>(result->kelvin[o][f]) -
          approached(r.knot_s[r.output_knot[o]], 6 * kHourS, 15 * kHourS, 315, 290, rate_s));
      EXPECT_LT(off, 1e-3) << o;
      EXPECT_LE(off, static_cast<double>(result->error_k[o][f])) << o;
    }
}

// Rationale: a jump is felt at once, and steps after it begin short, in bright sunlight and in the
// dark. Expected: with no refinement asked for, what halved steps change of a plate that follows in
// 20 minutes; it is twice as much where steps do not begin short.
TEST(SceneInside, StepsBeginShortAfterAJump) {
  SceneHeatRequest r = buried({{0.001, 1e6, 7850, 490}}, InnerSide::kAir);
  r.tolerance_k = 10;
  r.build_up[0].inner_h_w_m2_k = 3;
  r.build_up[0].inner_at = at_knots({{{6 * kHourS, 315}, {15 * kHourS, 290}}, true}, r.knot_s);
  const auto result = solve_scene_heat(disk(), r);
  ASSERT_TRUE(result.ok()) << result.status();
  for (const auto& row : result->error_k)
    for (const float error_k : row) EXPECT_LT(error_k, 0.045);
}

// Rationale: machinery that runs by day. In a storm convection is forced alone to 0.1 %: the root
// of 1 + (1.31 T^(1/3) / h)^2 at T = 5 K and h = 90 is 1.0003.
// Expected: the same approach to flux / h above the air, within 0.1 % of that; over the day as much
// heat goes out as came in, to the same.
TEST(SceneInside, MachineryWarmsAThinPlateAndItsHeatLeavesIt) {
  SceneHeatRequest r = day_of({290, 40, {1, 0, 0}, {0, 0, 1}, 0.0047, {0, 0, 0}, {0, 0, 0}});
  r.beneath = {.surface_z_m = INFINITY, .temperature_k = 290, .emissivity = 1, .solar_albedo = 0};
  r.part = {{0, 0, 0u, 0}};
  r.build_up.emplace_back();
  r.build_up[0].name = "casing";
  r.build_up[0].layers = {{0.03, 1e6, 7850, 490}};
  r.build_up[0].inner_side = InnerSide::kHeatFlux;
  const DaySchedule schedule{{{6 * kHourS, 450}, {15 * kHourS, 0}}, true};
  r.build_up[0].inner_at = at_knots(schedule, r.knot_s);
  r.output_knot.clear();
  for (std::size_t k = 0; k < 144; k += 2) r.output_knot.push_back(k);
  const Target target = disk();
  const auto result = solve_scene_heat(target, r);
  ASSERT_TRUE(result.ok()) << result.status();
  ASSERT_GT(target.facet[0].nx, 0.99) << "the wind comes from there";
  const double h = 3.26 * std::pow(40, 0.89), warmest_k = 450 / h, rate_s = 0.03 * 7850 * 490 / h;
  double out_j_m2 = 0;
  for (std::size_t o = 0; o < r.output_knot.size(); ++o) {
    const double t = r.knot_s[r.output_knot[o]], found = static_cast<double>(result->kelvin[o][0]);
    EXPECT_NEAR(found, 290 + approached(t, 6 * kHourS, 15 * kHourS, warmest_k, 0, rate_s),
                1e-3 * warmest_k + 1e-3)
        << t / kHourS;
    // Outputs are 20 minutes apart; the exponential between them is integrated as such.
    const bool on = t >= 6 * kHourS && t < 15 * kHourS;
    const double towards = on ? warmest_k : 0, apart_s = 1200,
                 share = rate_s / apart_s * (1 - std::exp(-apart_s / rate_s));
    out_j_m2 += h * apart_s * (towards + (found - 290 - towards) * share);
  }
  EXPECT_NEAR(out_j_m2, 450 * 9 * kHourS, 1.5e-3 * 450 * 9 * kHourS);
  EXPECT_LT(result->closure_w_m2, 1e-6);
}

// Rationale: a schedule that says the same all day is no schedule.
// Expected: the same bits.
TEST(SceneInside, AConstantScheduleIsTheConstant) {
  SceneHeatRequest constant = buried({{0.1, 1.4, 2300, 880}}, InnerSide::kAir);
  constant.build_up[0].inner_k = 303;
  constant.build_up[0].inner_h_w_m2_k = 8;
  SceneHeatRequest scheduled = constant;
  scheduled.build_up[0].inner_k = 0;
  scheduled.build_up[0].inner_at = at_knots({{{5 * kHourS, 303}}, true}, scheduled.knot_s);
  const auto a = solve_scene_heat(disk(), constant), b = solve_scene_heat(disk(), scheduled);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ(a->kelvin, b->kelvin);
  EXPECT_EQ(a->error_k, b->error_k);
  EXPECT_NEAR(a->kelvin[0][0], 303, 0.01);
}

TEST(SceneInside, WhatCannotBeIsRefused) {
  const auto message = [](const SceneHeatRequest& r) {
    return std::string(solve_scene_heat(disk(), r).status().message());
  };
  SceneHeatRequest r = buried({{0.1, 1.4, 2300, 880}}, InnerSide::kAdiabatic);
  r.build_up[0].inner_at.assign(r.knot_s.size(), {300, 300});
  EXPECT_EQ(message(r), "build_up \"wall\": nothing changes inside that is adiabatic or open");
  r.build_up[0].inner_side = InnerSide::kFixedTemperature;
  r.build_up[0].inner_at.pop_back();
  EXPECT_EQ(message(r), "build_up \"wall\": inside: one value for each knot");
}

}  // namespace
}  // namespace irsig
