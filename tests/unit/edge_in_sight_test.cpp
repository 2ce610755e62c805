// Rationale: a step at the edge of a map is an error where a view shows it, and harmless elsewhere.
// Expected: a wall at the edge is in sight where a straight line from the sensor reaches it inside
// the window, over all land between.
// Source: similar triangles over level land, in a frame whose Earth is flat.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "core/base/constants.h"
#include "core/sources/land.h"

namespace irsig {
namespace {

constexpr double kHalfM = 3000, kRangeM = 1000, kAboveM = 2;

using Shape = std::function<double(double x_m, double y_m)>;

// Land 6 km wide with a step at the middle of its east side.
//   ground_m  the ground beyond it
std::shared_ptr<LandScene> scene_of(const Shape& shape, double ground_m) {
  HeightGrid grid{-kHalfM, -kHalfM, 50, 120, 120, {}};
  for (std::uint32_t row = 0; row <= 120; ++row)
    for (std::uint32_t column = 0; column <= 120; ++column)
      grid.z_m.push_back(static_cast<float>(shape(-kHalfM + 50 * column, -kHalfM + 50 * row)));
  auto field = HeightField::create(std::move(grid));
  EXPECT_TRUE(field.ok()) << field.status();
  auto out = std::make_shared<LandScene>();
  out->field = std::make_shared<const HeightField>(*std::move(field));
  out->heading_deg = 90;
  out->edge_step = {{kHalfM, 0, *out->field->z_m(kHalfM, 0), ground_m}};
  return out;
}

// A sensor behind the target's stern looks to the east, through a window of 64 m.
bool seen(const std::shared_ptr<LandScene>& scene, double elevation_deg, double range_m = kRangeM,
          double azimuth_deg = 0, double bend_per_m = 0) {
  const Land land(scene, kAboveM, {0, 0, 0}, {}, bend_per_m);
  const double e = elevation_deg * kRadPerDeg, a = azimuth_deg * kRadPerDeg;
  return land
      .step_in_sight({-range_m * std::cos(e) * std::cos(a), -range_m * std::cos(e) * std::sin(a),
                      -range_m * std::sin(e)},
                     32)
      .has_value();
}

double plain(double, double) { return 0; }

TEST(LandEdgeInSight, AWallIsInTheWindowFromLowSensorsAlone) {
  const auto scene = scene_of(plain, 20);
  // The wall's foot lies 3000 tan(e) - 2 m above the line of sight, 4 km from the sensor: at the
  // window's upper side, 0.032 x 4 km, for e = 2.48 deg.
  for (const double elevation_deg : {0.2, 1.0, 2.4}) EXPECT_TRUE(seen(scene, elevation_deg));
  EXPECT_FALSE(seen(scene, 2.56));
  EXPECT_FALSE(seen(scene, 20));
  // The window is 0.032 to either side, and vertices stand for 50 m of the edge: (0.032 x 4000 +
  // 50) / 4000 = 2.55 deg seen from the sensor, 3.4 deg of the target's aspect.
  EXPECT_TRUE(seen(scene, 1, kRangeM, 3.2));
  EXPECT_FALSE(seen(scene, 1, kRangeM, 3.6));
  EXPECT_FALSE(seen(scene, 1, kRangeM, 180));
}

TEST(LandEdgeInSight, LandThatDropsToTheGroundShowsItsEdge) {
  EXPECT_TRUE(seen(scene_of(plain, -20), 2.4));
  EXPECT_FALSE(seen(scene_of(plain, -20), 2.56));
}

TEST(LandEdgeInSight, HillsHideTheEdge) {
  const Shape ridge = [](double x, double) {
    return 30 * std::exp(-std::pow((x - 1500) / 150, 2));
  };
  // From 19.5 m above the ground the line over the ridge rises by 10.5 m in 2.5 km: at the edge it
  // is 36 m high.
  EXPECT_FALSE(seen(scene_of(ridge, 20), 1));
  EXPECT_FALSE(seen(scene_of(ridge, -20), 1));
  EXPECT_FALSE(seen(scene_of(ridge, 34), 1));
  EXPECT_TRUE(seen(scene_of(ridge, 40), 1));
}

TEST(LandEdgeInSight, ASensorBeyondTheMapSeesItsNearWall) {
  const auto scene = scene_of(plain, -20);
  scene->edge_step[0].x_m = -kHalfM;
  EXPECT_TRUE(seen(scene, 0.1, 5000));
  EXPECT_FALSE(seen(scene, 2, 5000));
  EXPECT_FALSE(seen(scene, 0.1, 2500));  // behind the sensor
}

TEST(LandEdgeInSight, TheHighestStepIsTold) {
  const auto scene = scene_of(plain, 20);
  scene->edge_step.push_back({kHalfM, 50, 0, -35});
  scene->edge_step.push_back({kHalfM, 100, 0, 5});
  scene->edge_step.push_back({-kHalfM, 100, 0, 300});
  const Land land(scene, kAboveM, {0, 0, 0}, {});
  const auto step = land.step_in_sight({-kRangeM, 0, -20}, 32);
  ASSERT_TRUE(step.has_value());
  EXPECT_EQ(step->ground_z_m, -35);
}

// A bend b is that of rays that are straight above land raised by b r^2.
TEST(LandEdgeInSight, BentRaysSeeOverTheCurveOfTheEarth) {
  const double far_m = 3000, bend_per_m = 1e-6;
  const Shape bowl = [&](double x, double y) { return -bend_per_m * (x * x + y * y); };
  const auto scene = scene_of(bowl, bowl(far_m, 0) + 20);
  // With that bend the land is level and the sensor 1 m higher: the foot leaves the window at 2.42
  // deg instead of 2.48 deg.
  EXPECT_TRUE(seen(scene, 2.41, kRangeM, 0, bend_per_m));
  EXPECT_FALSE(seen(scene, 2.44, kRangeM, 0, bend_per_m));
  // Straight rays have the foot of the wall 9 m lower.
  EXPECT_TRUE(seen(scene, 2.56));
}

// The sensor is raised by 1 m, from 19.5 m: the line over the ridge is 35.7 m high at the edge, and
// 36.3 m where the sensor is not.
TEST(LandEdgeInSight, BentRaysSeeOverARidgeAsStraightOnesOfARaisedSensor) {
  const double bend_per_m = 1e-6, fall_m = bend_per_m * kHalfM * kHalfM;
  const Shape ridge = [&](double x, double y) {
    return 30 * std::exp(-std::pow((x - 1500) / 150, 2)) - bend_per_m * (x * x + y * y);
  };
  EXPECT_TRUE(seen(scene_of(ridge, 36.0 - fall_m), 1, kRangeM, 0, bend_per_m));
  EXPECT_FALSE(seen(scene_of(ridge, 35.4 - fall_m), 1, kRangeM, 0, bend_per_m));
}

}  // namespace
}  // namespace irsig
