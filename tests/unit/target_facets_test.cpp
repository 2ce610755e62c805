// Properties of facets that all views of a target share, against a look at each facet.
#include "core/scene/trace/target_facets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace irsig {
namespace {

double corner_area_m2(const std::array<Vec<Body>, 3>& corner) {
  return 0.5 * length(cross(corner[1] - corner[0], corner[2] - corner[0]));
}

// Facets anywhere, of three parts: two materials, the last part two-sided. Every seventh is a line.
Target many_sided_target(int facets) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> anywhere(-3, 3);
  Target target;
  target.part.resize(3);
  target.part[1].material = 1;
  target.part[2].two_sided = true;
  target.radius_m = 6;
  for (int t = 0; t < facets; ++t) {
    for (int k = 0; k < 3; ++k) {
      target.triangle.push_back(static_cast<std::uint32_t>(target.vertex.size() / 3));
      for (int axis = 0; axis < 3; ++axis)
        target.vertex.push_back(t % 7 == 6 ? 1.0f : std::round(anywhere(random)));
    }
    target.facet.push_back({0, 0, 1, static_cast<std::uint32_t>(t % 3)});
    const auto corner = target.corners(static_cast<std::size_t>(t));
    if (const Vec<Body> n = cross(corner[1] - corner[0], corner[2] - corner[0]); length(n) > 0) {
      const Vec<Body> unit = normalized(n);
      target.facet.back().nx = static_cast<float>(unit.x);
      target.facet.back().ny = static_cast<float>(unit.y);
      target.facet.back().nz = static_cast<float>(unit.z);
    }
  }
  return target;
}

TEST(TargetFacets, PartsAboveAreThoseOfALookAtEachVertex) {
  const Target target = many_sided_target(150);
  const TargetFacets facets;
  const PartsAbove& above = facets.parts_above(target);
  ASSERT_EQ(above.of_facet.size(), target.facet.size());
  std::vector<std::vector<bool>> of_part(3, std::vector<bool>(3, false));
  std::size_t empty = 0;
  for (std::size_t t = 0; t < target.facet.size(); ++t) {
    const auto corner = target.corners(t);
    const Target::Facet& facet = target.facet[t];
    const Vec<Body> middle = (1.0 / 3) * (corner[0] + corner[1] + corner[2]);
    for (const std::size_t side : {0u, 1u}) {
      std::vector<bool> expected(3, false);
      if (corner_area_m2(corner) > 0 && (side == 0 || facet.part == 2)) {
        const Vec<Body> n = (side == 0 ? 1.0 : -1.0) * Vec<Body>{facet.nx, facet.ny, facet.nz};
        for (std::size_t other = 0; other < target.facet.size(); ++other)
          for (const Vec<Body>& q : target.corners(other))
            if (dot(n, q - middle) > 1e-5) expected[target.facet[other].part] = true;
        for (std::size_t q = 0; q < 3; ++q)
          if (expected[q]) of_part[facet.part][q] = true;
      }
      EXPECT_EQ(above.set[above.of_facet[t][side]], expected) << "facet " << t << ", side " << side;
      empty += expected == std::vector<bool>(3, false) ? 1 : 0;
    }
  }
  EXPECT_EQ(above.of_part, of_part);
  EXPECT_GT(empty, 100u);
}

TEST(TargetFacets, FacingsHoldAllAreaOfEachMaterialAndKind) {
  const Target target = many_sided_target(3000);
  const TargetFacets facets;
  const std::vector<Facing>& facings = facets.facings(target);
  EXPECT_LT(facings.size(), 2500u);  // of 2572 facets with an area
  double expected[2][2] = {}, found[2][2] = {};
  Vec<Body> sum{0, 0, 0};
  for (std::size_t t = 0; t < target.facet.size(); ++t) {
    const Target::Facet& facet = target.facet[t];
    const PartSpec& part = target.part[facet.part];
    const double area = corner_area_m2(target.corners(t));
    expected[part.material][part.two_sided ? 1 : 0] += area;
    if (area > 0) sum = sum + area * Vec<Body>{facet.nx, facet.ny, facet.nz};
  }
  for (const Facing& f : facings) {
    found[f.material][f.two_sided ? 1 : 0] += f.area_m2;
    sum = sum - f.area_m2 * f.normal;
    EXPECT_LT(f.bent, 2 * kFacingCell);
    EXPECT_NEAR(length(f.normal), 1, 1e-12);
  }
  for (const int m : {0, 1})
    for (const int sides : {0, 1}) EXPECT_NEAR(found[m][sides], expected[m][sides], 1e-9);
  EXPECT_LT(length(sum), 1e-3);
}

}  // namespace
}  // namespace irsig
