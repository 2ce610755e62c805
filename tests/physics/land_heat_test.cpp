// Temperatures of kinds of land.
#include "core/thermal/land/land_heat.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "core/base/constants.h"
#include "core/land/kinds/make_land_kinds.h"
#include "core/land/objects/land_objects.h"
#include "core/thermal/clear_sky.h"
#include "core/thermal/evaporation.h"
#include "core/thermal/heat_solver.h"
#include "core/thermal/solids.h"
#include "heat_days.h"
#include "heat_scene.h"
#include "land_days.h"

namespace irsig {
namespace {

// Rationale: level land under a free horizon is one wall. Expected: what the solver of one wall
// finds for it.
TEST(LandHeat, LevelLandIsOneWall) {
  const LandKinds kinds = level_land({true});
  const LandHeatRequest r = land_day(600);
  const LandHeatResult land = solved(kinds, r);
  HeatRequest alone;
  alone.layers = r.material[0]->wall.layers;
  alone.inner_side = InnerSide::kAdiabatic;
  alone.knot_s = r.knot_s;
  Convection air = tarp_natural(1);
  air.mixing = 0;
  alone.outer = {{0.94, air}};
  alone.start = PeriodicStart{293, r.day_knots, 1e-3, 200};
  alone.output_knot = r.output_knot;
  alone.output_boundary = {0};
  const auto wall =
      solve_heat(alone, [&](std::size_t k, std::span<const std::uint32_t>, const Exposure& to) {
        const auto fill = [&](const HeatWeather& w, const HeatRadiation& light,
                              const FaceExposure& face) {
          face.absorbed_w_m2[0] = 0.75 * (light.direct_normal_w_m2 * std::max(0.0, -w.sun.z) +
                                          light.diffuse_horizontal_w_m2);
          face.incoming_w_m2[0] = light.sky_w_m2;
          face.fluid_k[0] = w.air_k;
          face.forced_h_w_m2_k[0] = 3.26 * std::pow(w.wind_m_s, 0.89);
        };
        fill(r.weather[k], r.weather[k].after, to.outer_begin);
        fill(r.weather[k + 1], r.weather[k + 1].before, to.outer_end);
      });
  ASSERT_TRUE(wall.ok()) << wall.status();
  for (std::size_t o = 0; o < r.output_knot.size(); ++o) {
    const double off = static_cast<double>(land.kelvin[o][0]) - wall->temperature_k[o];
    EXPECT_NEAR(off, 0, 0.02);
    EXPECT_LE(std::abs(off), static_cast<double>(land.error_k[o][0]) + 0.01);
    EXPECT_LT(land.error_k[o][0], 0.3f);
  }
}

// Rationale: light that jumps at a knot, a canopy, a heated inside and the convection factor reach
// the solver unchanged. Expected: the solver of one wall finds the same.
TEST(LandHeat, ACanopyOverAHeatedInsideIsOneWall) {
  constexpr double kFactor = 1.4, kAlpha = 0.75, kInnerH = 6;
  const LandKinds kinds = level_land({true});
  LandHeatRequest r = land_day(600);
  r.convection_factor = kFactor;
  WallBuildUp& wall = r.material[0]->wall;
  wall.layers = {{0.1, 1.0, 1800, 1000}};
  wall.inner_side = InnerSide::kAir;
  wall.inner_h_w_m2_k = kInnerH;
  wall.water = SurfaceWater{0, Canopy{2, 100}};
  const std::size_t hour = r.day_knots / 24, cloud = 11 * hour, heated = 4 * hour;
  for (std::size_t k = 0; k < r.knot_s.size(); ++k) {
    r.weather[k].humid = HumidAir{283, 101300};
    wall.inner_at.push_back({k <= heated ? 285.0 : 330.0, k < heated ? 285.0 : 330.0});
    const auto cover = [](HeatRadiation& light) {
      light.direct_normal_w_m2 = 0;
      light.diffuse_horizontal_w_m2 = 200;
      light.sky_w_m2 += 60;
    };
    if (k > cloud && k <= cloud + 3 * hour) cover(r.weather[k].before);
    if (k >= cloud && k < cloud + 3 * hour) cover(r.weather[k].after);
  }
  wall.inner_at.front().before = wall.inner_at.back().after = 330;
  wall.inner_at.back().before = 330;
  const LandHeatResult land = solved(kinds, r);
  HeatRequest alone;
  alone.layers = wall.layers;
  alone.inner_side = InnerSide::kAir;
  alone.knot_s = r.knot_s;
  Convection air = tarp_natural(1);
  air.mixing = 0;
  air.natural_warm *= kFactor;
  air.natural_cold *= kFactor;
  alone.outer = {{0.94, air, evaporation_of(*wall.water)}};
  for (std::size_t k = 0; k < r.knot_s.size(); ++k)
    alone.smooth.push_back(k != cloud && k != cloud + 3 * hour && k != heated);
  alone.start = PeriodicStart{293, r.day_knots, 1e-3, 200};
  alone.output_knot = r.output_knot;
  alone.output_boundary = {0};
  const auto wall_alone =
      solve_heat(alone, [&](std::size_t k, std::span<const std::uint32_t>, const Exposure& to) {
        const auto fill = [&](const HeatWeather& w, const HeatRadiation& light,
                              const FaceExposure& face) {
          const double sunlight =
              light.direct_normal_w_m2 * std::max(0.0, -w.sun.z) + light.diffuse_horizontal_w_m2;
          face.absorbed_w_m2[0] = kAlpha * sunlight;
          face.incoming_w_m2[0] = light.sky_w_m2;
          face.fluid_k[0] = w.air_k;
          face.forced_h_w_m2_k[0] = kFactor * 3.26 * std::pow(w.wind_m_s, 0.89);
          face.vapour_pa[0] = vapour_pressure_pa(283);
          face.inverse_gamma_k_pa[0] = inverse_gamma_k_pa(w.air_k, 101300);
          face.stomatal_w_m2_k[0] = stomatal_w_m2_k({2, 100}, sunlight, w.air_k, 101300);
        };
        fill(r.weather[k], r.weather[k].after, to.outer_begin);
        fill(r.weather[k + 1], r.weather[k + 1].before, to.outer_end);
        to.inner_begin.fluid_k[0] = wall.inner_at[k].after;
        to.inner_end.fluid_k[0] = wall.inner_at[k + 1].before;
        to.inner_begin.forced_h_w_m2_k[0] = to.inner_end.forced_h_w_m2_k[0] = kInnerH;
      });
  ASSERT_TRUE(wall_alone.ok()) << wall_alone.status();
  for (std::size_t o = 0; o < r.output_knot.size(); ++o)
    EXPECT_NEAR(land.kelvin[o][0], wall_alone->temperature_k[o], 0.01) << o;
}

// Rationale: under a cold sky a face is colder than the air, and its own natural convection warms
// it. Expected: the closed form of level land without sun or wind, with a convection factor.
TEST(LandHeat, AColdFaceHasTheConvectionFactor) {
  constexpr double kAirK = 290, kSky = 250, kFactor = 1.5;
  const LandKinds kinds = level_land({true});
  const SceneHeatRequest weather = steady(kAirK, kSky);
  LandHeatRequest r;
  r.knot_s = weather.knot_s;
  r.weather = weather.weather;
  r.day_knots = weather.day_knots;
  r.output_knot = weather.output_knot;
  r.convection_factor = kFactor;
  r.material = {LandHeatMaterial{steel(InnerSide::kAdiabatic), 0.7, 0.9}};
  r.stated_k = {0};
  double low = 250, high = kAirK;
  for (int i = 0; i < 60; ++i) {
    const double t = 0.5 * (low + high), h = kFactor * 1.81 / 2.382 * std::cbrt(kAirK - t);
    (0.9 * (kSky - kStefanBoltzmannWM2K4 * std::pow(t, 4)) + h * (kAirK - t) > 0 ? low : high) = t;
  }
  EXPECT_NEAR(solved(kinds, r).kelvin[1][0], low, 0.05);
}

// Rationale: in weather that stays, a face has the temperature of its balance. Expected: the closed
// form of level land, a slope, a wall, a hollow and land under a crown, in sun from the south.
TEST(LandHeat, InSteadyWeatherFacesHaveTheTemperatureOfTheirBalance) {
  constexpr double kAlpha = 0.7, kEmissivity = 0.9, kDirect = 500, kDiffuse = 80, kSky = 300,
                   kAirK = 290, kWind = 3, kFactor = 1.5, kHollow = 25 * kDeg, kLow = 20 * kDeg,
                   kHigh = 45 * kDeg;
  LandKinds kinds;
  kinds.materials = 1;
  kinds.computed = {true};
  kinds.on_objects = {true};
  kinds.horizon.resize(3);
  kinds.horizon[1].elevation_rad.fill(static_cast<float>(kHollow));
  kinds.horizon[2].lid_low_rad.fill(static_cast<float>(kLow));
  kinds.horizon[2].lid_high_rad.fill(static_cast<float>(kHigh));
  kinds.index_kinds();
  const double sun = 36.87 * kDeg;  // of elevation: hidden under the crown, seen from the hollow
  LandHeatRequest r;
  const SceneHeatRequest weather = steady(kAirK, kSky);
  r.knot_s = weather.knot_s;
  r.weather = weather.weather;
  for (HeatWeather& w : r.weather) {
    w.wind_m_s = kWind;
    w.wind_from = {-1, 0, 0};  // from the south: the target heads north
    w.sun = {-std::cos(sun), 0, -std::sin(sun)};
    w.before = w.after = {kDirect, kDiffuse, kSky};
  }
  r.day_knots = weather.day_knots;
  r.output_knot = weather.output_knot;
  r.convection_factor = kFactor;
  r.material = {LandHeatMaterial{steel(InnerSide::kAdiabatic), kAlpha, kEmissivity}};
  r.stated_k = {0};
  const LandHeatResult land = solved(kinds, r);
  const auto sigma4 = [](double k) { return kStefanBoltzmannWM2K4 * std::pow(k, 4); };
  const auto balance_k = [&](const LandKind& kind, double sky, bool lit, double level_k) {
    const double cosine =
        std::max(0.0, kind.normal.z * std::sin(sun) - kind.normal.y * std::cos(sun));
    const double light = (lit ? kDirect * cosine : 0) + sky * kDiffuse +
                         (1 - sky) * (1 - kAlpha) * (kDirect * std::sin(sun) + kDiffuse);
    const double around = kEmissivity * sigma4(level_k) + (1 - kEmissivity) * kSky,
                 lee = std::clamp(kind.normal.y, 0.0, 1.0);
    const auto heat = [&](double t) {
      const double c = std::abs(kind.normal.z),
                   n = t > kAirK ? 9.482 / (7.238 - c) : 1.81 / (1.382 + c),
                   forced =
                       std::lerp(3.26 * std::pow(kWind, 0.89), 3.55 * std::pow(kWind, 0.617), lee),
                   h = kFactor * std::hypot(n * std::cbrt(std::abs(t - kAirK)), forced);
      return kAlpha * light + kEmissivity * (sky * kSky + (1 - sky) * around - sigma4(t)) -
             h * (t - kAirK);
    };
    double low = 250, high = 400;
    for (int i = 0; i < 60; ++i) (heat(0.5 * (low + high)) > 0 ? low : high) = 0.5 * (low + high);
    return low;
  };
  const double level_k = balance_k(kinds.kind[0], 1, true, 0);
  EXPECT_NEAR(land.kelvin[1][0], level_k, 0.05);
  for (std::size_t k = 1; k < kinds.kind.size(); ++k) {
    const LandKind& kind = kinds.kind[k];
    if (kind.horizon > 0 && kind.normal.z < 1) continue;  // sky fractions of these are no formula
    const bool hollow = kind.horizon == 1, crown = kind.horizon == 2;
    const double sky = hollow  ? std::pow(std::cos(kHollow), 2)
                       : crown ? 1 - std::pow(std::sin(kHigh), 2) + std::pow(std::sin(kLow), 2)
                               : 0.5 * (1 + kind.normal.z);
    EXPECT_NEAR(land.kelvin[1][k], balance_k(kind, sky, !crown, level_k), crown ? 0.3 : 0.1)
        << k << " " << kind.normal.z;
  }
}

// Rationale: insulation follows light at once, so that an output just behind an edge of shade is as
// wrong as the light there. Expected: banks and crowns whose edges pass at all times have the same
// temperatures at coarse knots and at fine ones, within their errors.
TEST(LandHeat, ErrorsCoverEdgesOnLightGround) {
  LandKinds kinds;
  kinds.materials = 1;
  kinds.computed = {true};
  kinds.on_objects = {false};
  kinds.horizon.resize(7);
  for (std::size_t h = 1; h < kinds.horizon.size(); ++h) {
    const auto elevation = static_cast<float>((3 + 6.5 * static_cast<double>(h)) * kDeg);
    if (h % 2 == 0) {
      kinds.horizon[h].elevation_rad.fill(elevation);
    } else {
      kinds.horizon[h].lid_low_rad.fill(elevation);
      kinds.horizon[h].lid_high_rad.fill(elevation + static_cast<float>(15 * kDeg));
    }
  }
  kinds.index_kinds();
  LandHeatResult by_step[2];
  for (int i = 0; i < 2; ++i) {
    LandHeatRequest r = land_day(i == 0 ? 900 : 300);
    r.material[0]->wall.layers.insert(r.material[0]->wall.layers.begin(), {0.05, 0.03, 20, 1400});
    by_step[i] = solved(kinds, r);
  }
  double worst = 0, most_k = 0;
  for (std::size_t o = 0; o < by_step[0].kelvin.size(); ++o)
    for (std::size_t k = 0; k < kinds.kind.size(); ++k) {
      const double off =
          std::abs(static_cast<double>(by_step[0].kelvin[o][k] - by_step[1].kelvin[o][k]));
      const auto stated = static_cast<double>(by_step[0].error_k[o][k] + by_step[1].error_k[o][k]);
      worst = std::max(worst, off / (stated + 0.05));
      most_k = std::max(most_k, off);
    }
  std::printf("edges on insulation: up to %.2f K, %.2f of the stated error\n", most_k, worst);
  // Light that is a line from knot to knot is 21 K off.
  EXPECT_LT(worst, 1);
  EXPECT_LT(most_k, 0.3);
}

// Rationale: knots half an hour apart miss edges of shade. Expected: 0.05 K in the root mean
// square, and errors that cover what finer knots change, and are not ten times as large; and that
// contain what held-out places show.
TEST(LandHeat, ErrorsCoverCoarseKnots) {
  const LandKinds kinds = make_land_kinds(hills(150), {true}, {false}, 24);
  const LandHeatResult coarse = solved(kinds, land_day(1800)), fine = solved(kinds, land_day(300));
  double off2 = 0, stated2 = 0;
  for (std::size_t o = 0; o < coarse.kelvin.size(); ++o)
    for (std::size_t k = 0; k < kinds.kind.size(); ++k) {
      const auto error = static_cast<double>(coarse.error_k[o][k]),
                 off = static_cast<double>(coarse.kelvin[o][k] - fine.kelvin[o][k]),
                 held_out = static_cast<double>(coarse.interpolation_k[o][0]);
      EXPECT_GE(error, held_out);
      EXPECT_LE(std::abs(off), 1.2 * error + 0.02) << o << " " << k;
      off2 += off * off;
      stated2 += (error - held_out) * (error - held_out);
    }
  std::printf("knots: %.3f of the stated error\n", std::sqrt(off2 / stated2));
  const double rms =
      std::sqrt(off2 / static_cast<double>(coarse.kelvin.size() * kinds.kind.size()));
  std::printf("knots: rms %.4f K\n", rms);
  // Without lines along edges of shade it is 0.13 K.
  EXPECT_LT(rms, 0.08);
  EXPECT_LT(off2, stated2);
  EXPECT_GT(off2, 0.01 * stated2);
}

// Rationale: the frame of the weather is the target's. Expected: land does not know its heading.
TEST(LandHeat, TheTargetsHeadingChangesNothing) {
  const LandKinds kinds = make_land_kinds(hills(150), {true}, {true}, 8);
  const LandHeatResult a = solved(kinds, land_day(600)), b = solved(kinds, land_day(600, 77));
  for (std::size_t o = 0; o < a.kelvin.size(); ++o)
    for (std::size_t k = 0; k < kinds.kind.size(); ++k)
      EXPECT_NEAR(a.kelvin[o][k], b.kelvin[o][k], 2e-3);
}

// Rationale: a bank to the west takes the evening's sun. Expected: land east of it is as free land
// until then, and colder after.
TEST(LandHeat, ABankTakesTheEveningSun) {
  LandKinds kinds;
  kinds.materials = 1;
  kinds.computed = {true};
  kinds.on_objects = {false};
  kinds.horizon.resize(2);
  for (std::uint32_t i = 0; i < kHorizonAzimuths; ++i)
    if (i > kHorizonAzimuths / 2) kinds.horizon[1].elevation_rad[i] = static_cast<float>(40 * kDeg);
  kinds.index_kinds();
  const LandHeatRequest r = land_day(600);
  const LandHeatResult land = solved(kinds, r);
  double most_k = 0;
  for (std::size_t o = 0; o + 1 < r.output_knot.size(); ++o) {
    const double hour = (r.knot_s[r.output_knot[o]] - r.knot_s[0]) / 3600,
                 colder_k = static_cast<double>(land.kelvin[o][0] - land.kelvin[o][5]);
    // By day the bank, as warm as land, is warmer than the sky that it covers.
    if (hour >= 8 && hour <= 14) {
      EXPECT_NEAR(colder_k, -1.5, 2) << hour;
    }
    if (hour >= 16 && hour <= 18) {
      EXPECT_GT(colder_k, 2) << hour;
    }
    most_k = std::max(most_k, colder_k);
  }
  EXPECT_GT(most_k, 5);
}

// Rationale: kinds stand for all places; held-out ones show by how much. Expected on hills: 0.3 K
// in the root mean square over the day; more where slopes are steeper than those of the kinds.
TEST(LandHeat, KindsStandForHills) {
  for (const auto& [relief_m, most_k] : {std::pair{30.0, 0.1}, {150.0, 0.3}, {400.0, 0.5}}) {
    const auto begin = std::chrono::steady_clock::now();
    const LandKinds kinds = make_land_kinds(hills(relief_m), {true}, {false}, 64);
    const auto made = std::chrono::steady_clock::now();
    const LandHeatRequest r = land_day(600);
    const LandHeatResult land = solved(kinds, r);
    const auto end = std::chrono::steady_clock::now();
    double square = 0, worst = 0;
    for (std::size_t o = 0; o < r.output_knot.size(); ++o) {
      const auto rms = static_cast<double>(land.interpolation_k[o][0]);
      square += rms * rms / static_cast<double>(r.output_knot.size());
      worst = std::max(worst, rms);
    }
    std::printf(
        "relief %g m: %zu horizons, %zu kinds; rms %.3f K over the day, %.3f at its worst; "
        "%.2f s + %.2f s\n",
        relief_m, kinds.horizon.size(), kinds.kind.size(), std::sqrt(square), worst,
        std::chrono::duration<double>(made - begin).count(),
        std::chrono::duration<double>(end - made).count());
    EXPECT_LT(std::sqrt(square), most_k) << relief_m;
  }
}

TEST(LandHeat, FacesOfObjectsAreWallsAndRoofs) {
  LandScene land = land_of([](double, double) { return 0; }, 200, 10);
  const LandKinds kinds = make_land_kinds(land, {true}, {true}, 64);
  LandHeatRequest r = land_day(600);
  const LandHeatResult solution = solved(kinds, r);
  double square = 0, count = 0;
  for (std::size_t o = 0; o < r.output_knot.size(); ++o) {
    const auto rms = static_cast<double>(solution.interpolation_k[o][0]);
    square += rms * rms;
    ++count;
  }
  std::printf("walls and roofs: rms %.3f K\n", std::sqrt(square / count));
  EXPECT_LT(std::sqrt(square / count), 1);
  // In the morning an east wall is warmer than a west wall, in the evening it is colder.
  const auto wall_k = [&](std::size_t hour, double azimuth_deg) {
    std::vector<KindShare> mix;
    kinds.at(0, 0, tilted(90 * kDeg, azimuth_deg * kDeg), true, 1, mix);
    double k = 0;
    for (const KindShare& part : mix)
      k += static_cast<double>(part.share) * static_cast<double>(solution.kelvin[hour][part.kind]);
    return k;
  };
  EXPECT_GT(wall_k(9, 90), wall_k(9, 270) + 5);
  EXPECT_LT(wall_k(17, 90), wall_k(17, 270) - 5);
}

// Rationale: by day few slopes lie away from the sun and are colder than the rest; by night few
// places see less of the cold sky and are warmer. Expected: the skewness of the temperatures of
// hills is negative while the sun heats them and positive while they cool [wu2015].
TEST(LandHeat, SkewnessOfHillsChangesItsSign) {
  const LandScene land = hills(150);
  const LandKinds kinds = make_land_kinds(land, {true}, {false}, 0);
  const LandHeatRequest r = land_day(600);
  const LandHeatResult heat = solved(kinds, r);
  std::vector<std::vector<KindShare>> place;
  const std::vector<float> all{1.0f};
  for (double x = -1300; x <= 1300; x += 40)
    for (double y = -1300; y <= 1300; y += 40) {
      const auto slope = [&](double dx, double dy) {
        return (*land.field->z_m(x + dx, y + dy) - *land.field->z_m(x - dx, y - dy)) / 40;
      };
      kinds.at(x, y, normalized(Vec<Enu>{-slope(20, 0), -slope(0, 20), 1}), false, all,
               place.emplace_back());
    }
  std::vector<double> skewness;  // [output], one an hour
  for (const std::vector<float>& kelvin : heat.kelvin) {
    std::vector<double> at;
    double mean = 0;
    for (const std::vector<KindShare>& mix : place) {
      double k = 0;
      for (const KindShare& part : mix)
        k += static_cast<double>(part.share) * static_cast<double>(kelvin[part.kind]);
      at.push_back(k);
      mean += k / static_cast<double>(place.size());
    }
    double square = 0, cube = 0;
    for (const double k : at) {
      square += std::pow(k - mean, 2) / static_cast<double>(at.size());
      cube += std::pow(k - mean, 3) / static_cast<double>(at.size());
    }
    skewness.push_back(cube / std::pow(square, 1.5));
    std::printf("skewness %2zu h: %5.2f, sigma %.2f K\n", skewness.size() - 1, skewness.back(),
                std::sqrt(square));
  }
  ASSERT_EQ(skewness.size(), 25u);
  for (const std::size_t hour : {8u, 10u, 12u, 14u, 16u}) EXPECT_LT(skewness[hour], -0.5) << hour;
  for (const std::size_t hour : {0u, 2u, 4u, 20u, 22u}) EXPECT_GT(skewness[hour], 0.5) << hour;
}

}  // namespace
}  // namespace irsig
