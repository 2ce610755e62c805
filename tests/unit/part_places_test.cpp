// The tree finds vertices of a part above a plane as a look at each of them does.
#include "core/scene/trace/part_places.h"

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

// Planes of a sphere's facets, and of the facets of a flat plate that lies along no axis: they
// touch their own part, from which rounding alone sticks out.
TEST(PartPlaces, FewAreLookedAt) {
  constexpr std::uint32_t kSide = 200;
  const auto vertex = [](bool sphere, std::uint32_t i, std::uint32_t j) -> Vec<Body> {
    const double u = static_cast<double>(i) / kSide, v = static_cast<double>(j) / kSide;
    if (!sphere) return {u, v, 0.3 * u - 0.7 * v};
    const double polar = std::numbers::pi * (0.1 + 0.8 * u), turn = 6 * v;
    return {std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar)};
  };
  for (const bool sphere : {true, false}) {
    Target target;
    target.part.resize(1);
    std::vector<double> level;
    for (std::uint32_t i = 0; i < kSide; ++i)
      for (std::uint32_t j = 0; j < kSide; ++j) {
        const Vec<Body> a = vertex(sphere, i, j), b = vertex(sphere, i + 1, j),
                        c = vertex(sphere, i, j + 1);
        const Vec<Body> n = normalized(cross(b - a, c - a));
        target.facet.push_back(
            {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z), 0});
        level.push_back(dot(n, a));
        for (const Vec<Body>& q : {a, b, c}) {
          target.triangle.push_back(static_cast<std::uint32_t>(target.vertex.size() / 3));
          for (const double x : {q.x, q.y, q.z}) target.vertex.push_back(static_cast<float>(x));
        }
      }
    const PartPlaces places(target);
    std::size_t tried = 0, above = 0;
    for (std::size_t t = 0; t < target.facet.size(); ++t) {
      const Target::Facet& f = target.facet[t];
      // Where the sphere's level is positive the normal points outwards.
      const double side = sphere && level[t] < 0 ? -1 : 1;
      if (places.any_above(0, side * Vec<Body>{f.nx, f.ny, f.nz}, side * level[t] + 3e-5, tried))
        ++above;
    }
    EXPECT_EQ(above, 0u) << (sphere ? "sphere" : "plate");
    EXPECT_LT(static_cast<double>(tried), 300.0 * kSide * kSide) << (sphere ? "sphere" : "plate");
  }
}

}  // namespace
}  // namespace irsig
