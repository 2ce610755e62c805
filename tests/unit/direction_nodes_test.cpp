#include "core/environment/fit/direction_nodes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/environment/background_directions.h"

namespace irsig {
namespace {

double sum_of(const DirectionNodes& nodes, Vec<Body> d, std::vector<double>* at = nullptr) {
  DirectionNodes::Share share[4];
  const int n = nodes.shares(static_cast<float>(d.x), static_cast<float>(d.y),
                             static_cast<float>(d.z), share);
  EXPECT_GE(n, 1);
  EXPECT_LE(n, 4);
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    EXPECT_GT(share[i].weight, 0);
    EXPECT_LT(share[i].node, nodes.count());
    sum += static_cast<double>(share[i].weight);
    if (at) (*at)[share[i].node] += static_cast<double>(share[i].weight);
  }
  return sum;
}

TEST(DirectionNodes, SharesAddUpToOneEverywhere) {
  const DirectionNodes nodes({0.0f, 0.1f, 0.5f, 0.9f}, {0.02f, 0.4f}, 5, 0.7);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 10000; ++i) {
    const Vec<Body> d = normalized(Vec<Body>{normal(random), normal(random), normal(random)});
    EXPECT_NEAR(sum_of(nodes, d), 1, 1e-6);
  }
  for (const Vec<Body> d : {Vec<Body>{0, 0, -1}, Vec<Body>{0, 0, 1}, Vec<Body>{1, 0, 0},
                            Vec<Body>{-1, 0, 0}, Vec<Body>{-1, -1e-30, -0.0}}) {
    EXPECT_NEAR(sum_of(nodes, d), 1, 1e-6);
  }
}

TEST(DirectionNodes, ANodeHasAllOfItsOwnDirection) {
  const DirectionNodes nodes({0.0f, 0.25f, 0.75f}, {0.125f, 0.5f}, 8);
  for (std::uint32_t n = 0; n < nodes.count(); ++n) {
    std::vector<double> at(nodes.count(), 0.0);
    Vec<Body> d = nodes.direction(n);
    if (n < nodes.azimuths()) d.z = -1e-9;  // the ring on the horizon belongs to the sky
    sum_of(nodes, d, &at);
    EXPECT_NEAR(at[n], 1, 1e-5) << n;
    EXPECT_NEAR(-nodes.direction(n).z, nodes.sin_elevation(n), 1e-12);
    EXPECT_NEAR(length(nodes.direction(n)), 1, 1e-12);
  }
}

TEST(DirectionNodes, InterpolatesWhatIsLinearInSineExactly) {
  const DirectionNodes nodes({0.0f, 0.2f, 0.6f, 1.0f}, {0.0f, 1.0f}, 1);
  for (double s = 0.01; s < 1; s += 0.07) {
    const Vec<Body> d = {std::sqrt(1 - s * s), 0, -s};
    std::vector<double> at(nodes.count(), 0.0);
    sum_of(nodes, d, &at);
    double value = 0;
    for (std::uint32_t n = 0; n < nodes.sky(); ++n)
      value += at[n] * (3 - 2 * nodes.sin_elevation(n));
    EXPECT_NEAR(value, 3 - 2 * s, 1e-5);
  }
}

TEST(DirectionNodes, AzimuthRunsFromTheBowClockwise) {
  const DirectionNodes nodes({0.0f}, {0.0f}, 4);
  EXPECT_NEAR(nodes.direction(0).x, 1, 1e-12);
  EXPECT_NEAR(nodes.direction(1).y, 1, 1e-12);  // starboard
  std::vector<double> at(nodes.count(), 0.0);
  sum_of(nodes, {std::sqrt(0.5), -std::sqrt(0.5), -1e-9}, &at);  // between bow and port
  EXPECT_NEAR(at[0], 0.5, 1e-5);
  EXPECT_NEAR(at[3], 0.5, 1e-5);
}

TEST(DirectionNodes, SkyAndLowerDoNotMix) {
  const DirectionNodes nodes({0.1f, 1.0f}, {0.1f, 1.0f}, 1);
  std::vector<double> at(nodes.count(), 0.0);
  sum_of(nodes, {1, 0, -1e-4}, &at);
  EXPECT_NEAR(at[0], 1, 1e-9);  // beyond the first ring: that ring's
  sum_of(nodes, {1, 0, 1e-4}, &at);
  EXPECT_NEAR(at[2], 1, 1e-9);
}

TEST(BackgroundDirections, AreLinearBetweenAndJumpAtTheHorizon) {
  const BackgroundDirections nodes({-0.5f, 0.001f, 0.001f, 0.25f});
  BackgroundDirections::Share share[2];
  const auto at = [&](float z) {
    double sum = 0, mean = 0;
    for (int i = 0, n = nodes.shares(z, share); i < n; ++i) {
      sum += static_cast<double>(share[i].weight);
      mean += static_cast<double>(share[i].weight) * (share[i].node < 2 ? 1.0 : 5.0);
    }
    EXPECT_NEAR(sum, 1, 1e-7) << z;
    return mean;
  };
  for (const float z : {-1.0f, -0.5f, -0.2f, 0.0f, 0.000999f}) EXPECT_NEAR(at(z), 1, 1e-6) << z;
  for (const float z : {0.001f, 0.0011f, 0.2f, 0.25f, 1.0f}) EXPECT_NEAR(at(z), 5, 1e-6) << z;
  EXPECT_EQ(nodes.shares(-0.124750003f, share), 2);
  EXPECT_NEAR(share[1].weight, 0.749, 1e-3);
  EXPECT_TRUE(nodes.above(0, 0.001f));
  EXPECT_TRUE(nodes.above(1, 0.001f));
  EXPECT_FALSE(nodes.above(2, 0.001f));
  // Another weather's horizon lies between.
  EXPECT_TRUE(nodes.above(2, 0.1f));
  EXPECT_FALSE(nodes.above(3, 0.1f));
}

TEST(BackgroundDirections, SpanWhatIsLookedAtWithAJumpAtEachHorizon) {
  const std::vector<float> horizon = {0.0012f, 0.0011f, 0.0012f};
  const BackgroundDirections nodes = BackgroundDirections::spanning(-0.02, 0.03, horizon, 0);
  EXPECT_EQ(nodes.z(0), -0.02f);
  EXPECT_EQ(nodes.z(nodes.count() - 1), 0.03f);
  int jumps = 0;
  for (std::uint32_t n = 1; n < nodes.count(); ++n) {
    EXPECT_LE(nodes.z(n) - nodes.z(n - 1), 0.005f);
    jumps += nodes.z(n) == nodes.z(n - 1) ? 1 : 0;
  }
  EXPECT_EQ(jumps, 2);
  // No horizon in sight: no jump.
  const BackgroundDirections sky = BackgroundDirections::spanning(-0.9, -0.7, horizon, 0);
  for (std::uint32_t n = 1; n < sky.count(); ++n) EXPECT_LT(sky.z(n - 1), sky.z(n));
}

}  // namespace
}  // namespace irsig
