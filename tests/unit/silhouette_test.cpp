// Rationale: what stands behind a target that is seen from another range follows from its outline.
// Expected: areas (range^2 x solid angle) of a plate and a sphere, the fraction of a plate above a
// horizon, in closed form. What lies under the waterline or turns away does not count. Parts: the
// one in front hides the other.
// Source: closed forms written out here; the plate's solid angle by its four corners.
#include "view/moved/silhouette.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "view/moved/shape_change.h"

namespace irsig {
namespace {

// Upright, facing the bow; z down.
TargetShape plate(double at_x_m, double width_m, double bottom_m, double top_m) {
  const double y = width_m / 2;
  return {
      {{at_x_m, -y, -bottom_m}, {at_x_m, -y, -top_m}, {at_x_m, y, -top_m}, {at_x_m, y, -bottom_m}},
      {{0, 2, 3}, {0, 1, 2}},
      {0, 0},
      {true}};
}

// Returns the solid angle of a rectangle a x b at a distance d from the foot of its corner.
double corner_sr(double a, double b, double d) {
  return std::atan(a * b / (d * std::sqrt(a * a + b * b + d * d)));
}

TEST(SilhouetteTest, APlateIsExact) {
  constexpr double kRange = 500, kElevation = 1.2;
  const Viewpoint v{0, kElevation, kRange};
  const double up = kRange * std::sin(kElevation * std::numbers::pi / 180),
               along = kRange * std::cos(kElevation * std::numbers::pi / 180);
  // The horizontal through the sensor lies `up` high.
  const TargetShape shape = plate(0, 12, 0, 20);
  const float level = 0;
  const Silhouette s(shape, v, true, {&level, 1});
  const double above = 2 * corner_sr(6, 20 - up, along), below = 2 * corner_sr(6, up, along);
  EXPECT_NEAR(s.area_m2(), kRange * kRange * (above + below), 1e-5 * s.area_m2());
  const auto fractions = s.before(BackgroundDirections({0, 0}));
  EXPECT_NEAR(fractions.value[0], above / (above + below), 1e-5);
  EXPECT_NEAR(fractions.value[0] + fractions.value[1], 1, 1e-12);
  EXPECT_LT(fractions.error[0], 1e-5);
  // Half of it under water.
  const Silhouette wet(plate(0, 12, -20, 20), v, true, {&level, 1});
  EXPECT_NEAR(wet.area_m2(), s.area_m2(), 1e-5 * s.area_m2());
  const Silhouette dry(plate(0, 12, -20, 20), v, false, {&level, 1});
  EXPECT_GT(dry.area_m2(), 1.9 * s.area_m2());
  // A facet of one side is not seen from behind.
  TargetShape one_sided = shape;
  one_sided.two_sided = {false};
  EXPECT_NEAR(Silhouette(one_sided, v, true, {}).area_m2(), s.area_m2(), 1e-5 * s.area_m2());
  EXPECT_EQ(Silhouette(one_sided, {180, kElevation, kRange}, true, {}).area_m2(), 0);
}

TEST(SilhouetteTest, ASphereIsWithinItsError) {
  constexpr double kRadius = 5, kRange = 120;
  TargetShape sphere;
  constexpr int kRings = 90, kAround = 180;
  for (int i = 0; i <= kRings; ++i)
    for (int j = 0; j < kAround; ++j) {
      const double polar = std::numbers::pi * i / kRings, turn = 2 * std::numbers::pi * j / kAround;
      sphere.vertex.push_back({kRadius * std::sin(polar) * std::cos(turn),
                               kRadius * std::sin(polar) * std::sin(turn),
                               kRadius * std::cos(polar)});
    }
  const auto at = [](int i, int j) {
    return static_cast<std::uint32_t>(i * kAround + j % kAround);
  };
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kAround; ++j) {
      sphere.triangle.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      sphere.triangle.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  sphere.part.assign(sphere.triangle.size(), 0);
  sphere.two_sided = {false};
  const double sine = kRadius / kRange;
  const double expected = kRange * kRange * 2 * std::numbers::pi * (1 - std::sqrt(1 - sine * sine));
  for (const double elevation : {0.0, 40.0, 90.0}) {
    const Silhouette s(sphere, {30, elevation, kRange}, false, {});
    // Facets lie within 1 - cos(1 deg) of the sphere.
    EXPECT_NEAR(s.area_m2() / expected, 1, 6e-4) << elevation;
    EXPECT_LT(s.area_error_m2(), 1e-3 * expected);
    const double tilt = std::asin(sine);
    const double middle = elevation * std::numbers::pi / 180;
    EXPECT_NEAR(s.least_z(), std::sin(middle - tilt), 1e-3);
    if (elevation == 0) {
      EXPECT_NEAR(s.most_z(), std::sin(middle + tilt), 1e-3);
    }
  }
}

TEST(SilhouetteTest, AFloatingBoxHasFacetsThatAreShared) {
  // A hot wall half hidden by a cold one that stands 10 m nearer, 10 m high.
  TargetShape both = plate(0, 10, 0, 20);
  const TargetShape front = plate(10, 10, 0, 10);
  for (const Vec<Body>& v : front.vertex) both.vertex.push_back(v);
  for (auto t : front.triangle) both.triangle.push_back({t[0] + 4, t[1] + 4, t[2] + 4});
  both.part = {0, 0, 1, 1};
  both.two_sided = {true, true};
  const auto areas = [&](double range_m) { return part_areas(both, {0, 2, range_m}, true); };
  // The line over the upper edge of the front wall meets the other one so high.
  const auto hidden_m = [](double range_m) {
    const double up = range_m * std::sin(2 * std::numbers::pi / 180),
                 along = range_m * std::cos(2 * std::numbers::pi / 180);
    return 10 - (up - 10) / (along - 10) * 10;
  };
  for (const double range_m : {500.0, 15000.0}) {
    const PartAreas a = areas(range_m);
    const double expected = 10 * (20 - hidden_m(range_m));
    EXPECT_NEAR(a.area_m2[0] / expected, 1, 0.01) << range_m;
    EXPECT_NEAR(a.area_m2[0], expected, 5 * a.error_m2[0] + 0.003 * expected);
  }
  // The ratio of its light is that of both areas, each with its radiance.
  const Viewpoint from{0, 2, 500}, to{0, 2, 15000};
  const Silhouette before(both, from, true, {}), after(both, to, true, {});
  const ShapeAtRanges change(both, from, 15000, true, before, after);
  const PartAreas a0 = areas(500), a1 = areas(15000);
  const double hot = 50, cold = 20;
  const ShapeChange of =
      change.of({{hot * a0.area_m2[0], std::nan(""), 0}, {cold * a0.area_m2[1], std::nan(""), 0}});
  const double light = hot * a0.area_m2[0] + cold * a0.area_m2[1];
  EXPECT_NEAR(of.target_ratio, (hot * a1.area_m2[0] + cold * a1.area_m2[1]) / light, 2e-3);
  EXPECT_NEAR(of.area_ratio, after.area_m2() / before.area_m2(), 1e-12);
  EXPECT_LT(of.target_bound, 0.03);
  // Light that may lie anywhere on a part has a wider bound, parts of one radiance have a narrow
  // one.
  const ShapeChange uneven =
      change.of({{hot * a0.area_m2[0], std::nan(""), 1}, {cold * a0.area_m2[1], std::nan(""), 1}});
  EXPECT_GE(uneven.target_bound, of.target_bound);
}

}  // namespace
}  // namespace irsig
