// Rationale: the sampler is inverted, vectorised and folded for speed; each trick must give the
// plain definition's numbers. Expected: equality, or the stated rounding. Source: the definitions
// in core/base/sobol.h; the C library's sine and cosine; counting.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "core/base/sobol.h"
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
