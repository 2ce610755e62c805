#include "core/scene/trace/exact_facet.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

#include "core/scene/trace/reference_tracer.h"

namespace irsig {
namespace {

using Triangle = std::array<Point3, 3>;

// Returns the decision in whole numbers, without the infinitesimal: 1 met, 0 not met, -1 on an
// edge.
int in_integers(const Point3& o, const Point3& d, const Triangle& t) {
  using Int = __int128;
  Int v[3][3];
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t j = 0; j < 3; ++j)
      v[k][j] = static_cast<long>(t[k][j]) - static_cast<long>(o[j]);
  int sign[3];
  for (std::size_t k = 0; k < 3; ++k) {
    const Int* a = v[k];
    const Int* b = v[(k + 1) % 3];
    Int e = 0;
    for (std::size_t j = 0; j < 3; ++j)
      e += (a[(j + 1) % 3] * b[(j + 2) % 3] - a[(j + 2) % 3] * b[(j + 1) % 3]) *
           static_cast<long>(d[j]);
    sign[k] = e > 0 ? 1 : e < 0 ? -1 : 0;
  }
  if (sign[0] == 0 || sign[1] == 0 || sign[2] == 0) return -1;
  return sign[0] == sign[1] && sign[1] == sign[2] ? 1 : 0;
}

TEST(ExactFacet, AgreesWithWholeNumbers) {
  std::mt19937 random(1);
  int met = 0, on_edge = 0;
  // Coordinates up to 30 give many exact ties, up to 1e9 products beyond 53 bits.
  for (const int size : {30, 1'000'000'000}) {
    std::uniform_int_distribution<int> any(-size, size);
    const auto point = [&] {
      return Point3{double(any(random)), double(any(random)), double(any(random))};
    };
    for (int i = 0; i < 200'000; ++i) {
      Triangle t{point(), point(), point()};
      // Nearly flat ones, whose signs double arithmetic cannot tell.
      if (size > 1000 && i % 2 == 0)
        for (std::size_t j = 0; j < 3; ++j) t[2][j] = t[0][j] + (t[1][j] - t[0][j]) + (i % 3 - 1);
      const Point3 o = point(), to = i % 4 == 0 ? t[static_cast<std::size_t>(i / 4 % 3)] : point();
      const Point3 d{to[0] - o[0], to[1] - o[1], to[2] - o[2]};
      const int expected = in_integers(o, d, t);
      if (expected < 0) {
        ++on_edge;
        continue;
      }
      met += expected;
      EXPECT_EQ(exact_facet_hit(o, d, t[0], t[1], t[2]).met, expected == 1) << i;
    }
  }
  EXPECT_GT(met, 10'000);
  EXPECT_GT(on_edge, 10'000);
}

// Far from the origin, where the plain formula is lost: the point itself stays exact.
TEST(ExactFacet, PointAndSide) {
  const double far = 6.4e6;
  const Point3 a{far, far, far}, b{far + 1, far, far}, c{far, far + 1, far};
  const FacetHit from_above =
      exact_facet_hit({far + 0.25, far + 0.5, far + 8}, {0, 0, -2}, a, b, c);
  ASSERT_TRUE(from_above.met);
  EXPECT_TRUE(from_above.front);
  EXPECT_DOUBLE_EQ(from_above.t, 4);
  EXPECT_DOUBLE_EQ(from_above.u, 0.25);
  EXPECT_DOUBLE_EQ(from_above.v, 0.5);
  EXPECT_FALSE(exact_facet_hit({far + 0.25, far + 0.5, far - 8}, {0, 0, 2}, a, b, c).front);
  EXPECT_FALSE(exact_facet_hit({far + 0.5 + 1e-9, far + 0.5, far + 8}, {0, 0, -2}, a, b, c).met);
}

TEST(ExactFacet, NoAreaAndEdgeOnAreNeverMet) {
  EXPECT_FALSE(exact_facet_hit({0, 0, 1}, {0, 0, -1}, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}).met);
  EXPECT_FALSE(exact_facet_hit({1, 0, 1}, {0, 0, -1}, {0, 0, 0}, {1, 0, 0}, {2, 0, 0}).met);
  EXPECT_FALSE(exact_facet_hit({-1, 0.25, 0}, {1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}).met);
}

// A closed surface is left as often as it is entered, also by rays that go exactly through its
// vertices and along its edges, and from inside it is left once more.
TEST(ExactFacet, ClosedSurfacesStayClosedThroughVertices) {
  const std::vector<Point3> vertex = {{4, 0, 0},  {-4, 0, 0}, {0, 4, 0},
                                      {0, -4, 0}, {0, 0, 4},  {0, 0, -4}};
  const std::vector<std::uint32_t> facet = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                            2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  const ReferenceTracer octahedron(vertex, facet);
  int through = 0;
  for (int x = -9; x <= 9; ++x)
    for (int y = -9; y <= 9; ++y)
      for (int z = -9; z <= 9; ++z) {
        const int inside = std::abs(x) + std::abs(y) + std::abs(z);
        if (inside == 4) continue;  // on the surface
        const Point3 o{double(x), double(y), double(z)};
        for (const Point3& to : vertex) {
          for (const Point3& also : vertex) {
            const Point3 d{0.5 * (to[0] + also[0]) - o[0], 0.5 * (to[1] + also[1]) - o[1],
                           0.5 * (to[2] + also[2]) - o[2]};
            if (d == Point3{0, 0, 0}) continue;
            int fronts = 0, backs = 0;
            for (const ReferenceTracer::Hit& hit : octahedron.all(o, d, 0, 1e30))
              ++(hit.front ? fronts : backs);
            ASSERT_EQ(backs - fronts, inside < 4 ? 1 : 0) << x << " " << y << " " << z;
            ASSERT_EQ(octahedron.nearest(o, d, 0, 1e30).met(), backs > 0);
            ++through;
          }
        }
      }
  EXPECT_GT(through, 200'000);
}

// The tree finds what asking every facet finds.
TEST(ReferenceTracer, AgreesWithEveryFacetInTurn) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const double offset : {0.0, 6.4e6}) {
    std::vector<Point3> vertex;
    std::vector<std::uint32_t> facet;
    for (std::uint32_t i = 0; i < 900; ++i) {
      vertex.push_back({offset + unit(random), offset + unit(random), offset + unit(random)});
      facet.push_back(i);
    }
    const ReferenceTracer tracer(vertex, facet);
    for (int i = 0; i < 3000; ++i) {
      const Point3 o{offset + 3 * unit(random) - 1, offset + 3 * unit(random) - 1,
                     offset + 3 * unit(random) - 1};
      Point3 d{unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5};
      if (i % 3 == 0) d[static_cast<std::size_t>(i) % 2] = 0;
      std::uint32_t best = ReferenceTracer::kMiss;
      double t = 1e30;
      for (std::uint32_t f = 0; f < 300; ++f) {
        const FacetHit hit =
            exact_facet_hit(o, d, vertex[3 * f], vertex[3 * f + 1], vertex[3 * f + 2]);
        if (!hit.met || hit.t < 0 || hit.t >= t) continue;
        t = hit.t;
        best = f;
      }
      EXPECT_EQ(tracer.nearest(o, d, 0, 1e30).facet, best);
    }
  }
}

}  // namespace
}  // namespace irsig
