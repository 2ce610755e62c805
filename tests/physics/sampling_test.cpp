// Rationale: the sampler is inverted, vectorised and folded for speed; each trick must give the
// plain definition's numbers. Expected: equality, or the stated rounding. Source: the definitions
// in core/base/sobol.h; the C library's sine and cosine; counting.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "core/base/sobol.h"
#include "core/geo/frames.h"
#include "core/transport/cell_order.h"
#include "core/transport/vector_stages.h"

namespace irsig {
namespace {

TEST(Sobol, EveryElementaryIntervalHoldsOnePoint) {
  // 2^8 points: every box of size 2^-a x 2^-(8-a) holds exactly one, scrambled or shuffled.
  for (const bool shuffled : {false, true})
    for (int a = 0; a <= 8; ++a) {
      std::set<std::pair<int, int>> boxes;
      for (std::uint32_t i = 0; i < 256; ++i) {
        const SeedPair seed = seed_pair(99, 4);
        const SamplePair p = shuffled ? sobol_pair_shuffled(i, seed) : sobol_pair(i, seed);
        boxes.insert(
            {static_cast<int>(std::ldexp(p.x, a)), static_cast<int>(std::ldexp(p.y, 8 - a))});
      }
      EXPECT_EQ(boxes.size(), 256u) << a;
    }
}

TEST(CellOrder, EverySampleIsVisitedOnceAndLiesInItsCell) {
  for (const std::uint64_t samples : {1u, 2u, 16u, 100u, 1024u, 1500u}) {
    const std::array<SeedPair, 3> seeds = {seed_pair(1, 0), seed_pair(2, 0), seed_pair(3, 0)};
    const CellOrder order(samples, seeds);
    for (std::uint32_t r = 0; r < seeds.size(); ++r) {
      std::set<std::uint32_t> seen;
      for (std::uint32_t x = 0; x < order.side(); ++x)
        for (std::uint32_t y = 0; y < order.side(); ++y) {
          const std::uint32_t i = order.sample(r, x, y);
          if (i == CellOrder::kNone) continue;
          EXPECT_TRUE(seen.insert(i).second);
          const SamplePair p = sobol_pair(i, seeds[r]);
          EXPECT_EQ(static_cast<std::uint32_t>(p.x * static_cast<float>(order.side())), x);
          EXPECT_EQ(static_cast<std::uint32_t>(p.y * static_cast<float>(order.side())), y);
        }
      EXPECT_EQ(seen.size(), samples);
    }
  }
}

// Rationale: at grazing, with the sun nearly behind the facet, the half vector turns through many
// times the sun's radius; a probability that follows the disk's centre alone is then 0 where the
// lobe is not.
// Expected: brdf x cos at any point of the disk is at most 4 times what the probability stands for.
TEST(VectorStages, NoPointOfTheDiskIsMuchBrighterThanItsProbability) {
  constexpr double kRadius = 0.00465, kPi = std::numbers::pi;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  constexpr std::uint32_t kCount = 200000;
  std::vector<float> keep(1);
  double worst = 0;
  std::uint32_t bright = 0;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const double m = 0.01 * std::pow(40, unit(random));
    const double theta_o = kPi / 2 * (1 - std::pow(10, -4 * unit(random)));
    const double theta_i =
        std::clamp(theta_o + 4 * (m + kRadius) * (unit(random) - 0.5), 0.0, kPi / 2);
    const double phi = kPi + 4 * (m + kRadius) * (unit(random) - 0.5);
    const auto direction = [](double theta, double azimuth) {
      return Vec<Body>{std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth),
                       std::cos(theta)};
    };
    const Vec<Body> o = direction(theta_o, 0), sun = direction(theta_i, phi);
    VertexList one;
    one.resize(1);
    one.size = 1;
    one.nz[0] = 1;
    one.ox[0] = static_cast<float>(o.x);
    one.oy[0] = static_cast<float>(o.y);
    one.oz[0] = static_cast<float>(o.z);
    one.cos_o[0] = static_cast<float>(o.z);
    one.roughness2[0] = static_cast<float>(m * m);
    sun_probability(
        one, {static_cast<float>(sun.x), static_cast<float>(sun.y), static_cast<float>(sun.z)}, 0,
        static_cast<float>(kRadius), 1, keep.data());
    if (keep[0] >= 1) continue;
    const Vec<Body> t1 = normalized(cross(sun, Vec<Body>{0.3, 0.5, 0.1})), t2 = cross(sun, t1);
    const double highest = std::max(sun.z + kRadius, 1e-3);
    for (int k = 0; k < 48; ++k) {
      const double r = kRadius * std::sqrt((k / 8 + 1) / 6.0), a = 2 * kPi * (k % 8) / 8;
      const Vec<Body> wi = normalized(sun + r * std::cos(a) * t1 + r * std::sin(a) * t2);
      if (wi.z <= 0) continue;
      const Vec<Body> h = normalized(wi + o);
      const double cos2 = h.z * h.z, cos_d = dot(o, h);
      const double groove = std::min(1.0, 2 * h.z * std::min(wi.z, o.z) / cos_d);
      const double value =
          std::exp((1 - 1 / cos2) / (m * m)) * groove / (4 * m * m * cos2 * cos2 * o.z);
      if (value < 1e-20 * highest) continue;
      ++bright;
      worst = std::max(worst, value / (static_cast<double>(keep[0]) * highest));
    }
  }
  EXPECT_GT(bright, 100000u);
  EXPECT_LT(worst, 4);
}

TEST(VectorStages, DrawWhatTheSamplerDefines) {
  SampleList list;
  list.resize(1000);
  list.size = 999;
  for (std::uint32_t i = 0; i < list.size; ++i) {
    const SeedPair s = seed_pair(i / 100, 2);
    list.index[i] = 7 * i;
    list.seed_x[i] = s.x;
    list.seed_y[i] = s.y;
    list.seed_shuffle[i] = s.shuffle;
  }
  draw_pairs_shuffled(list);
  turn(list);
  for (std::uint32_t i = 0; i < list.size; ++i) {
    const SamplePair p = sobol_pair_shuffled(7 * i, seed_pair(i / 100, 2));
    EXPECT_EQ(list.x[i], p.x);
    EXPECT_EQ(list.y[i], p.y);
    EXPECT_NEAR(list.cos_y[i], std::cos(2 * std::numbers::pi * static_cast<double>(p.y)), 3e-7);
    EXPECT_NEAR(list.sin_y[i], std::sin(2 * std::numbers::pi * static_cast<double>(p.y)), 3e-7);
  }
}

}  // namespace
}  // namespace irsig
