// Kinds of land: what lies alike, and the horizons of places.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "core/land/kinds/make_land_kinds.h"
#include "core/land/objects/land_objects.h"
#include "heat_scene.h"
#include "land_days.h"

namespace irsig {
namespace {

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

}  // namespace
}  // namespace irsig
