// Whether vertices of a part lie above a plane: the tree says what a look at each of them says.
#include "core/scene/part_places.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace irsig {
namespace {

// Three parts: vertices anywhere, in one plane, and none at all.
Target random_target(std::mt19937& random, int facets) {
  std::uniform_real_distribution<float> anywhere(-3, 3);
  Target target;
  target.part.resize(3);
  for (int t = 0; t < facets; ++t) {
    const auto part = static_cast<std::uint32_t>(t % 2);
    target.facet.push_back({0, 0, 1, part});
    for (int k = 0; k < 3; ++k) {
      target.triangle.push_back(static_cast<std::uint32_t>(target.vertex.size() / 3));
      const float x = anywhere(random), y = anywhere(random);
      for (const float c : {x, y, part == 0 ? anywhere(random) : 0.5f * x - y})
        target.vertex.push_back(c);
    }
  }
  return target;
}

bool any_of_all(const Target& target, std::uint32_t part, Vec<Body> normal, double level) {
  for (std::size_t i = 0; i < target.triangle.size(); ++i) {
    const float* q = target.vertex.data() + 3 * target.triangle[i];
    if (target.facet[i / 3].part == part && dot(normal, Vec<Body>{q[0], q[1], q[2]}) > level)
      return true;
  }
  return false;
}

TEST(PartPlaces, SayWhatALookAtEachVertexSays) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal_of;
  std::uniform_real_distribution<double> level_of(-6, 6);
  int above = 0, asked = 0;
  for (const int facets : {1, 2, 6, 40, 700}) {
    const Target target = random_target(random, facets);
    const PartPlaces places(target);
    for (int i = 0; i < 300; ++i, ++asked) {
      const Vec<Body> normal =
          normalized(Vec<Body>{normal_of(random), normal_of(random), normal_of(random)});
      const double level = level_of(random);
      for (const std::uint32_t part : {0u, 1u, 2u}) {
        std::size_t tried = 0;
        const bool is = any_of_all(target, part, normal, level);
        EXPECT_EQ(places.any_above(part, normal, level, tried), is)
            << facets << " facets, part " << part << ", level " << level;
        above += is ? 1 : 0;
      }
    }
  }
  EXPECT_GT(above, asked / 4);
  EXPECT_LT(above, 2 * asked);
}

// The plane of a part's own flat side, from which rounding alone sticks out.
TEST(PartPlaces, FewAreLookedAt) {
  Target target;
  target.part.resize(1);
  constexpr std::uint32_t kSide = 300;
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
    const auto x = static_cast<float>(i % kSide), y = static_cast<float>(i / kSide);
    for (const float c : {x, y, std::sin(x) - 0.3f * y}) target.vertex.push_back(c);
    target.triangle.insert(target.triangle.end(), {i, i, i});
    target.facet.push_back({0, 0, 1, 0});
  }
  const PartPlaces places(target);
  std::size_t tried = 0;
  EXPECT_FALSE(places.any_above(0, normalized(Vec<Body>{0, 0.3, 1}), 1.01, tried));
  EXPECT_LT(tried, kSide * kSide / 4);
  EXPECT_TRUE(places.any_above(0, normalized(Vec<Body>{0, 0.3, 1}), 0.5, tried));
}

}  // namespace
}  // namespace irsig
