// Rationale: frames are where a sign error turns port into starboard and still looks like a ship.
// Expected: exact at the cardinal directions (the sines are exact there); elsewhere rotations keep
// lengths and undo
//   each other to 4 roundings.
// Source: the definitions: body x forward, y starboard, z down; local x east, y north, z up;
// heading clockwise from
//   north.
#include "core/geo/frames.h"

#include <gtest/gtest.h>

#include <cmath>

namespace irsig {
namespace {

constexpr Vec<Body> kBow{1, 0, 0};
constexpr Vec<Body> kStarboard{0, 1, 0};
constexpr Vec<Body> kKeel{0, 0, 1};

TEST(Frames, CardinalHeadingsAreExact) {
  const Vec<Enu> east{1, 0, 0};
  const Vec<Enu> north{0, 1, 0};
  const Vec<Enu> up{0, 0, 1};
  EXPECT_EQ(enu_from_body(kBow, 0), north);
  EXPECT_EQ(enu_from_body(kStarboard, 0), east);
  EXPECT_EQ(enu_from_body(kBow, 90), east);
  EXPECT_EQ(enu_from_body(kStarboard, 90), -1.0 * north);
  EXPECT_EQ(enu_from_body(kBow, 180), -1.0 * north);
  EXPECT_EQ(enu_from_body(kBow, 270), -1.0 * east);
  EXPECT_EQ(enu_from_body(kStarboard, 270), north);
  for (const double heading_deg : {0.0, 33.0, 90.0}) {
    EXPECT_EQ(enu_from_body(kKeel, heading_deg), -1.0 * up);
    EXPECT_EQ(body_from_enu(up, heading_deg), -1.0 * kKeel);
  }
  EXPECT_EQ(body_from_enu(east, 0), kStarboard);
  EXPECT_EQ(body_from_enu(north, 90), -1.0 * kStarboard);
}

TEST(Frames, HeadingIsClockwiseFromNorth) {
  const Vec<Enu> bow = enu_from_body(kBow, 30);
  EXPECT_NEAR(bow.x, 0.5, 1e-15);
  EXPECT_NEAR(bow.y, std::sqrt(0.75), 1e-15);
}

TEST(Frames, RotationsUndoEachOtherAndKeepHandedness) {
  const Vec<Body> a{0.3, -0.7, 1.9};
  const Vec<Body> b{-2.0, 0.4, 0.5};
  for (double heading_deg = -400; heading_deg <= 400; heading_deg += 37.3) {
    const Vec<Body> back = body_from_enu(enu_from_body(a, heading_deg), heading_deg);
    EXPECT_LE(length(back - a), 4 * 2.3e-16 * length(a));
    const auto turned = enu_from_body(cross(a, b), heading_deg);
    EXPECT_LE(length(cross(enu_from_body(a, heading_deg), enu_from_body(b, heading_deg)) - turned),
              1e-14);
  }
}

TEST(Frames, AspectPointsFromTargetToSensor) {
  EXPECT_EQ(body_from_aspect(0, 0), kBow);
  EXPECT_EQ(body_from_aspect(90, 0), kStarboard);
  EXPECT_EQ(body_from_aspect(180, 0), -1.0 * kBow);
  EXPECT_EQ(body_from_aspect(123, 90),
            -1.0 * kKeel);  // above the target: against z, which points down
  EXPECT_EQ(body_from_aspect(123, -90), kKeel);
  const Vec<Body> high = body_from_aspect(90, 30);
  EXPECT_NEAR(high.y, std::sqrt(0.75), 1e-15);
  EXPECT_NEAR(high.z, -0.5, 1e-15);
}

}  // namespace
}  // namespace irsig
