// Rationale: coordinates are rounded to 32 bits, which moves the outline of a small part far from
// the middle of a large model by much of its size. Expected: the area that is turned towards a
// direction, of the mesh as it was given and as it is kept, differs by no more than is stated; what
// is stated depends on the outline alone, however many facets it has. Source: double precision.
#include <gtest/gtest.h>

#include <cmath>

#include "core/scene/trace/target.h"

namespace irsig {
namespace {

// A plate of n x n squares, `side_m` wide, tilted, at `at`; and a box at the origin that has the
// middle of the model where it is.
Mesh far_plate(std::uint32_t n, double side_m, Vec<Body> at) {
  Mesh mesh;
  mesh.group = {"plate", "frame"};
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t k = 0; k <= n; ++k) {
      const double a = side_m * i / n, b = side_m * k / n;
      mesh.vertex.push_back(at +
                            Vec<Body>{0.8 * a + 0.1 * b, -0.2 * a + 0.9 * b, 0.5 * a - 0.3 * b});
    }
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t corner = i * (n + 1) + k;
      mesh.triangle.push_back({corner, corner + n + 1, corner + 1});
      mesh.triangle.push_back({corner + 1, corner + n + 1, corner + n + 2});
    }
  mesh.triangle_group.assign(mesh.triangle.size(), 0);
  const auto first = static_cast<std::uint32_t>(mesh.vertex.size());
  mesh.vertex.insert(mesh.vertex.end(), {-1.0 * at, {0, 0, 0}, {1, 0, 0}});
  mesh.triangle.push_back({first, first + 1, first + 2});
  mesh.triangle_group.push_back(1);
  return mesh;
}

Target target_of(const Mesh& mesh) {
  return make_target(mesh, {{"plate", {}, 0, true}, {"frame", {}, 0, true}}, widest_isa()).value();
}

double turned_m2(const Mesh& mesh, Vec<Body> towards, std::size_t facets) {
  double sum = 0;
  for (std::size_t f = 0; f < facets; ++f) {
    const auto& c = mesh.triangle[f];
    sum += 0.5 * std::abs(dot(cross(mesh.vertex[c[1]] - mesh.vertex[c[0]],
                                    mesh.vertex[c[2]] - mesh.vertex[c[0]]),
                              towards));
  }
  return sum;
}

TEST(TurnedArea, ChangesByNoMoreThanIsStated) {
  const Vec<Body> direction[] = {{0, 0, 1},
                                 {0, 0, -1},
                                 normalized(Vec<Body>{1, 2, 3}),
                                 normalized(Vec<Body>{-3, 1, 0.2}),
                                 normalized(Vec<Body>{0.4, 1, -2})};
  double largest = 0;
  for (const double far_m : {50.0, 3000.0, 12345.0, 4e5}) {
    const Mesh mesh = far_plate(1, 0.1 + far_m * 1e-5, {far_m, 0.7 * far_m, -0.3 * far_m});
    const Target target = target_of(mesh);
    for (const Vec<Body>& towards : direction) {
      const TurnedArea kept = turned_areas(target, towards)[0];
      const double given_m2 = turned_m2(mesh, towards, 2);
      EXPECT_LE(std::abs(kept.m2 - given_m2), 1.05 * kept.rounding_m2 + 1e-12 * given_m2);
      EXPECT_LT(kept.rounding_m2, 0.05 * kept.m2);
      largest = std::max(largest, std::abs(kept.m2 / given_m2 - 1));
    }
  }
  EXPECT_GT(largest, 1e-3);  // otherwise nothing was tried
}

TEST(TurnedArea, OfTheOutlineAlone) {
  const Vec<Body> towards = normalized(Vec<Body>{1, 2, 3});
  const auto stated = [&](std::uint32_t n) {
    return turned_areas(target_of(far_plate(n, 1, {5000, 3000, 100})), towards)[0];
  };
  const TurnedArea coarse = stated(1), fine = stated(60);
  EXPECT_NEAR(fine.m2 / coarse.m2, 1, 2e-3);
  EXPECT_LT(fine.rounding_m2, 4 * coarse.rounding_m2);
}

TEST(TurnedArea, FacetsThatAreTurnedAwayAreNotSeen) {
  Mesh mesh = far_plate(1, 1, {10, 0, 0});
  const Vec<Body> towards{0, 0, 1};
  const auto of = [&](bool two_sided) {
    return turned_areas(
        make_target(mesh, {{"plate", {}, 0, two_sided}, {"frame", {}, 0, true}}, widest_isa())
            .value(),
        towards)[0];
  };
  const double one = of(false).m2, both = of(true).m2;
  for (auto& t : mesh.triangle) std::swap(t[0], t[1]);
  EXPECT_NEAR(one + of(false).m2, both, 1e-6 * both);
  EXPECT_EQ(std::min(one, of(false).m2), 0);
}

}  // namespace
}  // namespace irsig
