// Kinds of land and their temperatures.
#include "core/thermal/land/land_heat.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "core/base/constants.h"
#include "core/land/generate_terrain.h"
#include "core/land/kinds/make_land_kinds.h"
#include "core/land/objects/land_objects.h"
#include "core/thermal/clear_sky.h"
#include "core/thermal/evaporation.h"
#include "core/thermal/heat_solver.h"
#include "core/thermal/solids.h"
#include "heat_days.h"
#include "heat_scene.h"

namespace irsig {
namespace {

constexpr double kPi = std::numbers::pi, kDeg = kPi / 180;

LandScene land_of(const std::function<double(double, double)>& z, double half_m, double spacing_m) {
  HeightGrid grid{-half_m, -half_m, spacing_m, 0, 0, {}};
  grid.columns = grid.rows = static_cast<std::uint32_t>(std::lround(2 * half_m / spacing_m));
  for (std::uint32_t row = 0; row <= grid.rows; ++row)
    for (std::uint32_t column = 0; column <= grid.columns; ++column)
      grid.z_m.push_back(
          static_cast<float>(z(grid.west_m + column * spacing_m, grid.south_m + row * spacing_m)));
  auto field = HeightField::create(std::move(grid));
  EXPECT_TRUE(field.ok()) << field.status();
  LandScene out;
  out.field = std::make_shared<const HeightField>(*std::move(field));
  return out;
}

// Made-up hills of so many metres, as local metres around the target.
LandScene hills(double relief_m) {
  const double width_m = 3000, spacing_m = 20;
  const auto raster = generate_terrain({5, width_m, spacing_m, relief_m}, "heights");
  EXPECT_TRUE(raster.ok()) << raster.status();
  const auto columns = raster->columns;
  return land_of(
      [&](double x, double y) {
        const auto at = [&](double along) {
          return static_cast<std::size_t>(
              std::clamp(along / spacing_m + 0.5 * (columns - 1), 0.0, columns - 1.0));
        };
        return static_cast<double>(raster->height_m[(columns - 1 - at(y)) * columns + at(x)]);
      },
      1400, spacing_m);
}

LandHeatRequest land_day(double step_s, double turned_deg = 0) {
  const SceneHeatRequest day = clear_day(step_s, turned_deg);
  LandHeatRequest out;
  out.knot_s = day.knot_s;
  out.weather = day.weather;
  out.day_knots = day.day_knots;
  out.output_knot = day.output_knot;
  out.heading_deg = turned_deg;
  out.material = {LandHeatMaterial{day.build_up[0], 0.75, 0.94}};
  out.stated_k = {0};
  return out;
}

LandHeatResult solved(const LandKinds& kinds, const LandHeatRequest& request) {
  auto out = solve_land_heat(kinds, request);
  EXPECT_TRUE(out.ok()) << out.status();
  return *std::move(out);
}

Vec<Enu> tilted(double tilt, double azimuth) {
  return {std::sin(tilt) * std::sin(azimuth), std::sin(tilt) * std::cos(azimuth), std::cos(tilt)};
}

// Rationale: a place is the mean of kinds. Expected: shares that add up to 1, none negative, and on
// the ground kinds whose mean normal lies in the place's direction.
TEST(LandKinds, APlaceIsAMeanOfKinds) {
  LandKinds kinds;
  kinds.materials = 2;
  kinds.computed = {false, true};
  kinds.on_objects = {false, true};
  kinds.horizon.resize(3);
  kinds.index_kinds();
  EXPECT_EQ(kinds.kind.size(), 1u + 3 * 5 + 25);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(0, 1);
  for (int i = 0; i < 20000; ++i) {
    const bool object = i % 2 == 0;
    const double tilt = u(random) * (object ? 90 : 29) * kDeg, azimuth = 2 * kPi * u(random);
    const Vec<Enu> normal = tilted(tilt, azimuth);
    std::vector<KindShare> mix;
    kinds.at(1, 2, normal, object, 0.5f, mix);
    double sum = 0;
    Vec<Enu> mean;
    for (const KindShare& part : mix) {
      ASSERT_LT(part.kind, kinds.kind.size());
      const LandKind& kind = kinds.kind[part.kind];
      ASSERT_EQ(kind.material, 1u);
      ASSERT_EQ(kind.object, object);
      ASSERT_EQ(kind.horizon, object ? 0u : 2u);
      ASSERT_GT(part.share, 0);
      sum += static_cast<double>(part.share);
      mean = mean + static_cast<double>(part.share) * kind.normal;
    }
    ASSERT_NEAR(sum, 0.5, 1e-6);
    if (object) {
      ASSERT_LT(length(normalized(mean) - normal), 0.21) << tilt / kDeg;
    } else if (tilt < 20 * kDeg) {
      ASSERT_NEAR(2 * mean.x, normal.x, 1e-6);
      ASSERT_NEAR(2 * mean.y, normal.y, 1e-6);
    }
  }
  std::vector<KindShare> mix;
  kinds.at(0, 1, {0, 0, 1}, false, 1, mix);
  ASSERT_EQ(mix.size(), 1u);
  EXPECT_EQ(mix[0].kind, 0u);
}

// Rationale: a valley between two banks has a horizon in closed form. Expected: each cell's horizon
// is that of its group, within what one group holds together and the resolution.
TEST(LandKinds, HorizonsOfAValleyAreThoseOfItsBanks) {
  // Banks of 30 m at 60 m east and west, steep; free to the north and south for 800 m.
  const LandScene land =
      land_of([](double x, double) { return std::abs(x) > 60 ? 30.0 : 0.0; }, 800, 4);
  const LandKinds kinds = make_land_kinds(land, {true}, {false}, 16);
  ASSERT_GE(kinds.horizon.size(), 2u);
  for (const double x : {-30.0, 0.0, 30.0}) {
    const LandHorizon& seen = kinds.horizon[kinds.horizon_at(x, 2)];
    for (const double azimuth_deg : {45.0, 90.0, 112.5, 270.0}) {
      const double east = std::sin(azimuth_deg * kDeg),
                   to_bank_m = (east > 0 ? 62 - x : 62 + x) / std::abs(east),
                   expected = std::atan2(30, to_bank_m);
      EXPECT_NEAR(seen.at(azimuth_deg * kDeg) / kDeg, expected / kDeg, 9)
          << x << " " << azimuth_deg;
    }
    EXPECT_LT(seen.at(0), 5 * kDeg);
  }
  EXPECT_EQ(kinds.horizon_at(1e6, -1e6), kinds.horizon_at(790, -790));
  ASSERT_EQ(kinds.held_out.size(), 16u);
}

// Rationale: a face that looks down has no roof like it. Expected: it counts as a wall.
TEST(LandKinds, AFaceThatLooksDownIsAWall) {
  LandKinds kinds;
  kinds.materials = 1;
  kinds.computed = {true};
  kinds.on_objects = {true};
  kinds.horizon.resize(1);
  kinds.index_kinds();
  std::vector<KindShare> mix;
  kinds.at(0, 0, tilted(150 * kDeg, 100 * kDeg), true, 1, mix);
  ASSERT_FALSE(mix.empty());
  for (const KindShare& part : mix) {
    EXPECT_NEAR(kinds.kind[part.kind].normal.z, 0, 1e-6);
    EXPECT_GT(kinds.kind[part.kind].normal.x, 0.8);
  }
}

TEST(LandKinds, TheNearestAzimuthIsAtMostHalfAStepAway) {
  constexpr double kStep = 2 * kPi / kHorizonAzimuths;
  for (std::uint32_t i = 0; i < kHorizonAzimuths; ++i)
    for (const double off : {-0.45, 0.0, 0.45})
      EXPECT_EQ(LandHorizon::nearest((i + off) * kStep), i) << off;
}

Mesh faces(const std::vector<std::array<Vec<Body>, 4>>& quads) {
  Mesh out;
  out.group = {"default"};
  for (const auto& q : quads) {
    const auto first = static_cast<std::uint32_t>(out.vertex.size());
    out.vertex.insert(out.vertex.end(), q.begin(), q.end());
    out.triangle.push_back({first, first + 1, first + 2});
    out.triangle.push_back({first, first + 2, first + 3});
    out.triangle_group.insert(out.triangle_group.end(), 2, 0);
  }
  return out;
}

// Rationale: objects hide the sky as land does, and roofs hang above free sky. Expected: elevations
// of a wall and of a roof's two edges, within what one group holds together.
TEST(LandKinds, ObjectsAreHorizonsAndLids) {
  LandScene land = land_of([](double, double) { return 0; }, 60, 2);
  ObjectModel roof;
  // Forward is north: body x is north, y is east.
  roof.mesh = faces({{{{-6, -55, -4}, {6, -55, -4}, {6, 55, -4}, {-6, 55, -4}}},
                     {{{-0.1, 0, 0}, {0.1, 0, 0}, {0.1, 0, -4}, {-0.1, 0, -4}}}});
  roof.material = {0};
  roof.place = {{0, 0, 0, 1, 0}};
  ObjectModel wall;
  wall.mesh = faces({{{{0, -55, 0}, {0, 55, 0}, {0, 55, -20}, {0, -55, -20}}}});
  wall.material = {0};
  wall.place = {{0, 50, 0, 1, 0}};
  auto objects = LandObjects::create({roof, wall}, *land.field);
  ASSERT_TRUE(objects.ok()) << objects.status();
  land.objects = std::make_shared<const LandObjects>(*std::move(objects));
  const LandKinds kinds = make_land_kinds(land, {true}, {false}, 0);
  EXPECT_EQ(kinds.square.front().cell_m, 2);
  // Just before the wall, which is to the north.
  const LandHorizon& before = kinds.horizon[kinds.horizon_at(1, 41)];
  EXPECT_NEAR(before.elevation_rad[0] / kDeg, std::atan2(20, 9) / kDeg, 15);
  EXPECT_LT(before.elevation_rad[kHorizonAzimuths / 2], 3 * kDeg);
  // Under the middle of the roof: free below its edges.
  const LandHorizon& under = kinds.horizon[kinds.horizon_at(5, -1)];
  const std::uint32_t south = kHorizonAzimuths / 2;
  EXPECT_NEAR(under.lid_low_rad[south] / kDeg, std::atan2(4, 5) / kDeg, 15);
  EXPECT_NEAR(under.lid_high_rad[south] / kDeg, 90, 1);
  EXPECT_LT(under.elevation_rad[south], 3 * kDeg);
}

// Rationale: a material has kinds under the horizons that it has somewhere. Expected: fewer kinds
// than all, and for every other horizon the one most like it among those that it has.
TEST(LandKinds, AMissingHorizonHasTheOneMostLikeIt) {
  LandScene land = land_of([](double x, double) { return std::abs(x) > 60 ? 30.0 : 0.0; }, 800, 4);
  HeightRaster east{LocalMetres{}, -810, -810, 4, 4, 406, 406, {}};
  for (std::uint32_t row = 0; row < east.rows; ++row)
    for (std::uint32_t column = 0; column < east.columns; ++column) {
      const double x = east.x0 + column * east.x_step;
      east.height_m.push_back(std::abs(x - 40) < 12 || std::abs(x - 400) < 50 ? 1.0F : 0.0F);
    }
  auto cover =
      LandCover::create(std::vector<CoverLayer>{{"east", east}, {"rest"}}, *land.field, {});
  ASSERT_TRUE(cover.ok()) << cover.status();
  land.cover = *std::move(cover);
  const LandKinds kinds = make_land_kinds(land, {true, true}, {false, false}, 0);
  const std::size_t horizons = kinds.horizon.size();
  ASSERT_EQ(kinds.stand_in.size(), 2 * horizons);
  EXPECT_LT(kinds.kind.size(), 2 * 5 * horizons);
  const std::size_t of_east = static_cast<std::size_t>(
      std::count_if(kinds.kind.begin(), kinds.kind.end(),
                    [](const LandKind& kind) { return kind.material == 0; }));
  EXPECT_GE(of_east, 2U * 5) << "or there is no choice";
  const auto off2 = [&](std::size_t a, std::size_t b) {
    double sum = 0;
    for (std::uint32_t i = 0; i < kHorizonAzimuths; ++i)
      sum += std::pow(kinds.horizon[a].elevation_rad[i] - kinds.horizon[b].elevation_rad[i], 2);
    return sum;
  };
  for (std::size_t m = 0; m < 2; ++m)
    for (std::size_t h = 0; h < horizons; ++h) {
      const std::size_t stands = kinds.stand_in[m * horizons + h];
      EXPECT_EQ(kinds.stand_in[m * horizons + stands], stands);
      for (std::size_t other = 0; other < horizons; ++other)
        if (kinds.stand_in[m * horizons + other] == other) {
          EXPECT_LE(off2(h, stands), off2(h, other) + 1e-9) << m << " " << h;
        }
    }
}

TEST(LandKinds, FlatLandHasOneHorizon) {
  const LandKinds kinds =
      make_land_kinds(land_of([](double, double) { return 3; }, 500, 10), {true}, {false}, 8);
  EXPECT_EQ(kinds.horizon.size(), 1u);
  EXPECT_EQ(kinds.kind.size(), 5u);
}

// Rationale: level land under a free horizon is one wall. Expected: what the solver of one wall
// finds for it.
TEST(LandHeat, LevelLandIsOneWall) {
  LandKinds kinds;
  kinds.materials = 1;
  kinds.computed = {true};
  kinds.on_objects = {false};
  kinds.horizon.resize(1);
  kinds.index_kinds();
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
  LandKinds kinds;
  kinds.materials = 1;
  kinds.computed = {true};
  kinds.on_objects = {false};
  kinds.horizon.resize(1);
  kinds.index_kinds();
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
  LandKinds kinds;
  kinds.materials = 1;
  kinds.computed = {true};
  kinds.on_objects = {false};
  kinds.horizon.resize(1);
  kinds.index_kinds();
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

}  // namespace
}  // namespace irsig
