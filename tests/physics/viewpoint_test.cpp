// Rationale: the viewpoint set is the sampling of the database, and the line of sight decides
// whether a target is seen
//   at all; both must hold at poles, at the zenith and beyond the horizon.
// Expected: Fibonacci sets are equal-area (the mean unit vector of a zone is known in closed form);
// positions agree
//   with geodesy in closed form at the equator and the poles to 1e-8 m.
// Source: gonzalez2010 (lattice), WGS 84 a = 6378137 m, 1/f = 298.257223563; spherical
// trigonometry.
#include "core/geo/viewpoint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/constants.h"
#include "core/geo/line_of_sight.h"

namespace irsig {
namespace {

constexpr double kEquatorialRadiusM = 6378137.0;

TEST(Viewpoints, FibonacciIsEqualArea) {
  const auto set = fibonacci_viewpoints(191, 5000, 0, 90);
  ASSERT_EQ(set.size(), 191u);
  Vec<Body> mean{};
  double second_moment = 0;
  for (const Viewpoint& v : set) {
    const auto u = body_from_aspect(v.aspect_azimuth_deg, v.aspect_elevation_deg);
    mean = mean + (1.0 / 191) * u;
    second_moment += u.z * u.z / 191;
    EXPECT_EQ(v.range_m, 5000);
    EXPECT_GE(v.aspect_azimuth_deg, 0);
    EXPECT_LT(v.aspect_azimuth_deg, 360);
    EXPECT_GT(v.aspect_elevation_deg, 0);
    EXPECT_LT(v.aspect_elevation_deg, 90);
  }
  // Over a hemisphere: mean height 1/2 (exactly that of mid points), mean square 1/3 - 1/(12 n^2),
  // and the horizontal mean vanishes as 1/n.
  EXPECT_NEAR(-mean.z, 0.5, 1e-14);
  EXPECT_NEAR(second_moment, 1.0 / 3 - 1.0 / (12.0 * 191 * 191), 1e-14);
  EXPECT_LT(std::hypot(mean.x, mean.y), 1.0 / 191);
}

// The closest pair of the lattice is at its pole: the last point and the third before it, at sqrt(2
// x 0.5 / n) and sqrt(2 x 3.5 / n) from the zenith (flat there) and three golden angles apart. That
// is 0.81 of what a hexagonal packing would reach.
TEST(Viewpoints, FibonacciHasNoCloseNeighbours) {
  const auto set = fibonacci_viewpoints(500, 1, 0, 90);
  double closest = 10;
  for (std::size_t i = 0; i < set.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const auto a = body_from_aspect(set[i].aspect_azimuth_deg, set[i].aspect_elevation_deg);
      const auto b = body_from_aspect(set[j].aspect_azimuth_deg, set[j].aspect_elevation_deg);
      closest = std::min(closest, length(a - b));
    }
  }
  const double three_golden_angles = 3 * 2 * std::numbers::pi * (2 - std::numbers::phi);
  EXPECT_NEAR(closest * std::sqrt(500.0),
              std::sqrt(1 + 7 - 2 * std::sqrt(7.0) * std::cos(three_golden_angles)), 0.002);
}

TEST(Viewpoints, FibonacciZoneKeepsItsLimits) {
  for (const Viewpoint& v : fibonacci_viewpoints(1000, 1, -5, 12)) {
    EXPECT_GT(v.aspect_elevation_deg, -5);
    EXPECT_LT(v.aspect_elevation_deg, 12);
  }
  const auto one = fibonacci_viewpoints(1, 1, 30, 30);
  ASSERT_EQ(one.size(), 1u);
  EXPECT_NEAR(one[0].aspect_elevation_deg, 30, 1e-13);
  EXPECT_TRUE(fibonacci_viewpoints(0, 1, 0, 90).empty());
}

TEST(Viewpoints, GridAndRingOrder) {
  const auto grid = grid_viewpoints({-90, 0, 360}, {10, 20}, 7);
  ASSERT_EQ(grid.size(), 6u);
  EXPECT_EQ(grid[0].aspect_azimuth_deg, 270);
  EXPECT_EQ(grid[2].aspect_azimuth_deg, 0);
  EXPECT_EQ(grid[2].aspect_elevation_deg, 10);
  EXPECT_EQ(grid[3].aspect_elevation_deg, 20);
  const auto ring = ring_viewpoints(8, {0, 45}, 7);
  ASSERT_EQ(ring.size(), 16u);
  EXPECT_EQ(ring[3].aspect_azimuth_deg, 135);
  EXPECT_EQ(ring[15].aspect_azimuth_deg, 315);
  EXPECT_EQ(ring[15].aspect_elevation_deg, 45);
}

// On the equator, along it, the section of the ellipsoid is a circle: everything is plane
// trigonometry.
TEST(LineOfSight, EquatorInClosedForm) {
  const GeodeticPosition target{0, 130, 0};
  for (const double elevation_deg : {-0.06, 0.0, 0.5, 10.0, 60.0, 90.0}) {
    for (const double range_m : {200.0, 5e3, 2e4, 1e6}) {
      const auto line = line_of_sight(target, 0, {90, elevation_deg, range_m});  // starboard = east
      const double e = elevation_deg * kRadPerDeg;
      const double up = kEquatorialRadiusM + range_m * std::sin(e);
      const double along = range_m * std::cos(e);
      const double radius = std::hypot(up, along);
      EXPECT_NEAR(line.sensor.height_m, radius - kEquatorialRadiusM, 1e-8);
      EXPECT_NEAR(line.sensor.latitude_deg, 0, 1e-12);
      EXPECT_NEAR(line.sensor.longitude_deg, 130 + std::atan2(along, up) / kRadPerDeg, 1e-12);
      // The angles of the triangle centre-target-sensor add up to 180 deg.
      const double zenith_at_target = 90 - elevation_deg;
      EXPECT_NEAR(line.los_zenith_deg, 180 - zenith_at_target + std::atan2(along, up) / kRadPerDeg,
                  1e-9);
      const double lowest = elevation_deg >= 0 ? 0.0
                            : along > -2 * kEquatorialRadiusM * std::tan(e)
                                ? kEquatorialRadiusM * (std::cos(e) - 1)
                                : radius - kEquatorialRadiusM;
      EXPECT_NEAR(line.lowest_height_m, lowest, 1e-8) << elevation_deg << " deg, " << range_m;
    }
  }
}

// Frigate and sensor at the pole, across it and across the antimeridian: the same triangle
// everywhere, because the pole is a centre of symmetry and longitude is one.
TEST(LineOfSight, PolesAndAntimeridian) {
  const auto at_pole = line_of_sight({90, 0, 0}, 0, {0, 20, 1e4});
  for (const double aspect_deg : {45.0, 90.0, 200.0, 359.0}) {
    const auto turned = line_of_sight({90, 0, 0}, 0, {aspect_deg, 20, 1e4});
    EXPECT_NEAR(turned.sensor.height_m, at_pole.sensor.height_m, 1e-8);
    EXPECT_NEAR(turned.sensor.latitude_deg, at_pole.sensor.latitude_deg, 1e-12);
  }
  const auto west = line_of_sight({10, 179.999, 0}, 0, {90, 5, 1e4});
  const auto plain = line_of_sight({10, 20, 0}, 0, {90, 5, 1e4});
  EXPECT_NEAR(west.sensor.height_m, plain.sensor.height_m, 1e-8);
  EXPECT_NEAR(west.sensor.longitude_deg + 360 - 179.999, plain.sensor.longitude_deg - 20, 1e-11);
  EXPECT_LT(west.sensor.longitude_deg, -179.9);
}

TEST(LineOfSight, OverheadIsExactlyOverhead) {
  const auto line = line_of_sight({47.5, -8, 12}, 77, {33, 90, 5000});
  EXPECT_NEAR(line.sensor.height_m, 5012, 1e-8);
  EXPECT_NEAR(line.los_zenith_deg, 180, 1e-9);
  EXPECT_NEAR(line.sensor.latitude_deg, 47.5, 1e-12);
}

// A sensor 20 m up sees the 10 m high top of a ship 20 km away at an elevation of -0.06 deg, over
// the horizon of a sphere at sqrt(2 R h) = 16 + 11.3 km; its waterline is hidden. Beyond 27.3 km
// nothing of it is seen.
TEST(LineOfSight, SeaHidesTheHullFromAfar) {
  const GeodeticPosition target{0, 0, 0};
  const auto at_height = [](double range_m,
                            double height) {  // a point above the sea at that range, eastward
    const double angle = range_m / kEquatorialRadiusM;
    const double r = kEquatorialRadiusM + height;
    return Vec<Enu>{r * std::sin(angle), 0, r * std::cos(angle) - kEquatorialRadiusM};
  };
  const Vec<Enu> sensor = at_height(20e3, 20);
  EXPECT_NEAR(height_m(target, sensor), 20, 1e-8);
  const Vec<Enu> top{0, 0, 10};
  EXPECT_NEAR(std::atan2(sensor.z - top.z, sensor.x) / kRadPerDeg, -0.06, 0.005);
  // Closed form: the perpendicular from the Earth's centre onto the line.
  const double length_m = length(sensor - top);
  const double perpendicular = (kEquatorialRadiusM + 10) * sensor.x / length_m;
  EXPECT_NEAR(lowest_height_m(target, top, sensor), perpendicular - kEquatorialRadiusM, 1e-7);
  EXPECT_GT(lowest_height_m(target, top, sensor), 0);
  EXPECT_LT(lowest_height_m(target, {0, 0, 0.1}, sensor), -0.5);
  const double horizon_m =
      std::sqrt(2 * kEquatorialRadiusM * 20) + std::sqrt(2 * kEquatorialRadiusM * 10);
  EXPECT_GT(lowest_height_m(target, top, at_height(horizon_m - 50, 20)), 0);
  EXPECT_LT(lowest_height_m(target, top, at_height(horizon_m + 50, 20)), 0);
}

}  // namespace
}  // namespace irsig
