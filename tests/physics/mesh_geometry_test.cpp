// Rationale: intensities are areas times radiances. A faceted body that is too small, an import
// that loses digits, or a ship with the wrong silhouette shifts every result by that much, and no
// statistics would show it.
// Expected: areas along the axis exact to rounding; other projections within the bounds that mesh.h
// states, which follow from the expansion of a regular m-gon of equal area,
//   mean width / (2 R) - 1 = pi^2 / (6 m^2) = 1.645 / m^2,   for odd m within pi^2 / (12 m^2) of
//   it,
// corners at pi^2 / (3 m^2) outside the circle, middles of sides pi^2 / (6 m^2) inside;
// imports exact to the rounding of a double at the file's coordinates.
// Source: closed forms (box |n.x| bc + |n.y| ca + |n.z| ab; cylinder pi R^2 |cos| + 2 R H sin; cone
// by its nose and base; Cauchy's theorem, mean silhouette of a convex body = surface / 4); ship:
// 153.8 x 20.4 m, 6.4 m freeboard and 16 m2 of hot wall as in the ship paper's Tables 1 and 3,
// areas by integration of the frigate's own lines by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <random>

#include "core/scene/generate/generate_mesh.h"
#include "core/scene/import/import_mesh.h"
#include "core/scene/mesh.h"
#include "core/scene/mesh_measure.h"

namespace irsig {
namespace {

using std::numbers::pi;

Vec<Body> facet_area(const Mesh& mesh, std::size_t i) {
  const auto& t = mesh.triangle[i];
  return 0.5 * cross(mesh.vertex[t[1]] - mesh.vertex[t[0]], mesh.vertex[t[2]] - mesh.vertex[t[0]]);
}

// The silhouette of a convex body; of a one-sided surface, the area that faces the viewer.
double facing_area_m2(const Mesh& mesh, Vec<Body> to_viewer) {
  double area_m2 = 0;
  for (std::size_t i = 0; i < mesh.triangle.size(); ++i)
    area_m2 += std::max(0.0, dot(facet_area(mesh, i), to_viewer));
  return area_m2;
}

std::vector<Vec<Body>> directions(int count) {
  std::mt19937_64 random(20);
  std::normal_distribution<double> normal;
  std::vector<Vec<Body>> out;
  for (int i = 0; i < count; ++i)
    out.push_back(normalized(Vec<Body>{normal(random), normal(random), normal(random)}));
  return out;
}

TEST(MeshGeometry, DiskHasTheAreaOfTheCircle) {
  const double radius_m = std::sqrt(0.782024 / pi);  // the blackbody disk of the ship paper
  for (const std::uint64_t triangles : {3u, 4u, 5u, 100u, 1234u, 100000u}) {
    const Mesh mesh = generate_mesh({"disk", triangles, radius_m}).value();
    EXPECT_NEAR(facing_area_m2(mesh, {1, 0, 0}), 0.782024, 1e-12) << triangles;
    EXPECT_EQ(facing_area_m2(mesh, {-1, 0, 0}), 0) << triangles;
    EXPECT_NEAR(facing_area_m2(mesh, {0.5, 0.6, -std::sqrt(0.39)}), 0.391012, 1e-12) << triangles;
  }
}

TEST(MeshGeometry, BoxIsExact) {
  const Mesh mesh = generate_mesh({"box", 3000}).value();
  for (const Vec<Body>& d : directions(50)) {
    EXPECT_NEAR(facing_area_m2(mesh, d),
                std::abs(d.x) * 0.5 + std::abs(d.y) * 1 + std::abs(d.z) * 2, 1e-12);
  }
}

// The corners on the largest ring: the m of the accuracy statement.
double points_around(const Mesh& mesh) {
  double radius_m = 0;
  for (const Vec<Body>& v : mesh.vertex) radius_m = std::max(radius_m, std::hypot(v.y, v.z));
  double count = 0, x_m = -1e9;
  for (const Vec<Body>& v : mesh.vertex) {
    if (std::hypot(v.y, v.z) < radius_m * (1 - 1e-9)) continue;
    if (x_m == -1e9) x_m = v.x;
    if (v.x == x_m) ++count;
  }
  return count;
}

TEST(MeshGeometry, CylinderWithinTheStatedBounds) {
  constexpr double radius_m = 0.5, length_m = 3;
  for (const std::uint64_t triangles : {200u, 2000u, 20000u}) {
    const Mesh mesh = generate_mesh({"cylinder", triangles}).value();
    const double m = points_around(mesh);
    EXPECT_NEAR(facing_area_m2(mesh, {1, 0, 0}), pi * radius_m * radius_m, 1e-12);
    double mean = 0;
    constexpr int azimuths = 400;
    for (int i = 0; i < azimuths; ++i) {
      const double angle_rad = 2 * pi * (i + 0.3) / azimuths;
      const double excess = facing_area_m2(mesh, {0, std::cos(angle_rad), std::sin(angle_rad)}) /
                                (2 * radius_m * length_m) -
                            1;
      EXPECT_LT(std::abs(excess - 1.645 / (m * m)), 0.823 / (m * m) + 9 / std::pow(m, 4)) << m;
      mean += excess / azimuths;
    }
    EXPECT_NEAR(mean, 1.645 / (m * m), 0.1 / (m * m)) << m;
    for (const Vec<Body>& d : directions(50)) {
      const double sine = std::hypot(d.y, d.z);
      const double exact =
          pi * radius_m * radius_m * std::abs(d.x) + 2 * radius_m * length_m * sine;
      EXPECT_NEAR(facing_area_m2(mesh, d), exact, exact * 2.468 / (m * m) * 1.02);
    }
  }
}

TEST(MeshGeometry, ConeWithinTheStatedBounds) {
  // Silhouettes of the closed cone R = 1, H = 2 seen from theta off its nose; beyond the flank's
  // slope the nose shows: area = base ellipse + two tangent triangles.
  const auto exact = [](double theta_rad) {
    constexpr double radius_m = 1, height_m = 2;
    const double c = std::abs(std::cos(theta_rad)), s = std::sin(theta_rad);
    const double base = pi * radius_m * radius_m * c;
    if (height_m * s <= radius_m * c) return base;
    const double touch = std::acos(radius_m * c / (height_m * s));  // where tangents meet the base
    return base + radius_m * std::sqrt(height_m * height_m * s * s - radius_m * radius_m * c * c) -
           radius_m * radius_m * c * touch;
  };
  EXPECT_NEAR(exact(pi / 4), 2.705705850777711, 1e-12);  // independent values for two of them
  EXPECT_NEAR(exact(170 * pi / 180), 3.093864802061424, 1e-12);
  double worst = 0;
  for (const std::uint64_t triangles : {200u, 2000u, 20000u}) {
    const Mesh mesh = generate_mesh({"cone", triangles}).value();
    const double m = points_around(mesh);
    EXPECT_NEAR(facing_area_m2(mesh, {-1, 0, 0}), pi, 1e-12);
    EXPECT_NEAR(facing_area_m2(mesh, {1, 0, 0}), pi, 1e-12);
    for (const Vec<Body>& d : directions(200)) {
      const double silhouette = exact(std::acos(d.x));
      const double excess = m * m * (facing_area_m2(mesh, d) / silhouette - 1);
      EXPECT_GT(excess, -3.3) << m;
      EXPECT_LT(excess, 6.6) << m;
      worst = std::max(worst, std::abs(excess));
    }
  }
  std::printf("worst x m^2: %.2f\n", worst);
}

// The silhouette itself, by the hull of the projected vertices: facets of a sphere might have been
// folded inwards, and the facing area would then count more than is seen.
double hull_area_m2(const Mesh& mesh, Vec<Body> d) {
  const Vec<Body> u =
      normalized(cross(d, std::abs(d.x) < 0.5 ? Vec<Body>{1, 0, 0} : Vec<Body>{0, 1, 0}));
  const Vec<Body> v = cross(d, u);
  std::vector<std::pair<double, double>> point;
  for (const Vec<Body>& p : mesh.vertex) point.emplace_back(dot(p, u), dot(p, v));
  std::sort(point.begin(), point.end());
  const auto turn = [](const auto& a, const auto& b, const auto& c) {
    return (b.first - a.first) * (c.second - a.second) -
           (b.second - a.second) * (c.first - a.first);
  };
  std::vector<std::pair<double, double>> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t start = hull.size();
    for (const auto& p : point) {
      while (hull.size() >= start + 2 && turn(hull[hull.size() - 2], hull.back(), p) <= 0)
        hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(point.begin(), point.end());
  }
  double area_m2 = 0;
  for (std::size_t i = 1; i + 1 < hull.size(); ++i)
    area_m2 += 0.5 * turn(hull[0], hull[i], hull[i + 1]);
  return area_m2;
}

TEST(MeshGeometry, SphereWithinTheStatedBounds) {
  for (const std::uint64_t triangles : {100u, 1000u, 20000u, 200000u}) {
    const Mesh mesh = generate_mesh({"sphere", triangles, 2}).value();
    EXPECT_NEAR(measure(mesh).area_m2 / (16 * pi), 1, 1e-12);
    const double n = static_cast<double>(mesh.triangle.size());
    double mean = 0, worst = 0;
    constexpr int count = 60;
    for (const Vec<Body>& d : directions(count)) {
      const double excess = hull_area_m2(mesh, d) / (4 * pi) - 1;
      mean += excess / count;
      worst = std::max(worst, std::abs(excess));
    }
    EXPECT_LT(worst, 3 / n) << triangles;
    EXPECT_LT(std::abs(mean), 1 / n) << triangles;
    std::printf("%g triangles: worst x triangles %.2f, mean %.2f\n", n, worst * n, mean * n);
  }
}

// A 0.25 m facet in Earth-centred metres: a double is spaced by 9.3e-10 m there, a float by 0.5 m.
TEST(MeshGeometry, TextFilesFarFromTheOriginLoseNothing) {
  constexpr double x = 6378137.123456789, y = -2.5e6, z = 3.1e6 + 0.1;
  char obj[400], stl[600];
  std::snprintf(obj, sizeof obj,
                "v %.17g %.17g %.17g\nv %.17g %.17g %.17g\nv %.17g %.17g %.17g\nf 1 2 3\n", x, y, z,
                x + 0.25, y, z, x, y + 0.25, z + 0.125);
  std::snprintf(stl, sizeof stl,
                "solid s\nfacet normal 0 0 0\nouter loop\nvertex %.17g %.17g %.17g\n"
                "vertex %.17g %.17g %.17g\nvertex %.17g %.17g %.17g\nendloop\nendfacet\nendsolid\n",
                x, y, z, x + 0.25, y, z, x, y + 0.25, z + 0.125);
  for (const auto& [name, text] : {std::pair("a.obj", obj), {"a.stl", stl}}) {
    const absl::StatusOr<Mesh> mesh = import_mesh(text, {name, 1, "+x", "+z", "bbox_center"});
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    const auto& v = mesh->vertex;
    // The file's own numbers, not the ideal ones: what is subtracted is exact.
    EXPECT_EQ(v[1].x - v[0].x, (x + 0.25) - x);
    EXPECT_EQ(v[2].y - v[0].y, -((y + 0.25) - y));
    EXPECT_EQ(v[2].z - v[0].z, -((z + 0.125) - z));
    EXPECT_NEAR(length(v[1] - v[0]), 0.25, 1e-9);
    EXPECT_LT(length(v[0]), 0.25);
  }
}

// The silhouette of some groups on a grid of squares.
double silhouette_m2(const Mesh& mesh,
                     const std::function<std::pair<double, double>(Vec<Body>)>& flat,
                     const std::function<bool(const std::string&)>& counts, double pixel_m) {
  constexpr int width = 4000, height = 1400;
  std::vector<char> seen(static_cast<std::size_t>(width) * height, 0);
  for (std::size_t i = 0; i < mesh.triangle.size(); ++i) {
    if (!counts(mesh.group[mesh.triangle_group[i]])) continue;
    double u[3], v[3];
    for (std::size_t j = 0; j < 3; ++j) {
      const auto [a, b] = flat(mesh.vertex[mesh.triangle[i][j]]);
      u[j] = a / pixel_m + width / 2;
      v[j] = b / pixel_m + height / 2;
    }
    for (int row = static_cast<int>(*std::min_element(v, v + 3));
         row <= static_cast<int>(*std::max_element(v, v + 3)); ++row) {
      double first = 1e9, last = -1e9;  // where the row's middle enters and leaves the facet
      for (std::size_t j = 0; j < 3; ++j) {
        const std::size_t k = (j + 1) % 3;
        const double part = (row + 0.5 - v[j]) / (v[k] - v[j]);
        if (v[k] == v[j] || part < 0 || part > 1) continue;
        first = std::min(first, u[j] + part * (u[k] - u[j]));
        last = std::max(last, u[j] + part * (u[k] - u[j]));
      }
      for (int column = static_cast<int>(std::ceil(first - 0.5)); column + 0.5 <= last; ++column)
        seen[static_cast<std::size_t>(row) * width + static_cast<std::size_t>(column)] = 1;
    }
  }
  return static_cast<double>(std::count(seen.begin(), seen.end(), 1)) * pixel_m * pixel_m;
}

TEST(MeshGeometry, FrigateHasTheSilhouetteOfItsLines) {
  const Mesh mesh = generate_mesh({"frigate", 20000}).value();
  const auto side = [](Vec<Body> p) { return std::pair(p.x, p.z + 20); };
  const auto top = [](Vec<Body> p) { return std::pair(p.x, p.y); };
  const auto bow = [](Vec<Body> p) { return std::pair(p.y, p.z + 20); };
  const auto all = [](const std::string&) { return true; };
  const auto is_hull = [](const std::string& group) { return group == "hull" || group == "deck"; };
  // Deck plan 2 x 153.8 x (3.34833 + 2.04 + 3.26141) and side of the hull 1013.6 - 8.6 by hand.
  EXPECT_NEAR(silhouette_m2(mesh, top, all, 0.04), 2660.7, 0.002 * 2660.7);
  EXPECT_NEAR(silhouette_m2(mesh, side, is_hull, 0.04), 1005.0, 0.002 * 1005);
  const double side_m2 = silhouette_m2(mesh, side, all, 0.04),
               bow_m2 = silhouette_m2(mesh, bow, all, 0.04);
  EXPECT_NEAR(side_m2, 1774, 8);  // as drawn; the sizes of the README
  EXPECT_NEAR(bow_m2, 334, 3);
  std::printf("side %.1f m2, bow %.1f m2\n", side_m2, bow_m2);
}

// Returns the number of solids in which a point lies: signed crossings of a ray upwards.
int solids_around(const Mesh& mesh, Vec<Body> p) {
  int crossings = 0;
  const Vec<Body> up = normalized(Vec<Body>{0.0123, 0.0345, -1});
  for (std::size_t i = 0; i < mesh.triangle.size(); ++i) {
    const auto& t = mesh.triangle[i];
    const Vec<Body> a = mesh.vertex[t[0]] - p, b = mesh.vertex[t[1]] - p, c = mesh.vertex[t[2]] - p;
    const double x = dot(up, cross(a, b)), y = dot(up, cross(b, c)), z = dot(up, cross(c, a));
    const bool leaves = x > 0 && y > 0 && z > 0, enters = x < 0 && y < 0 && z < 0;
    if (!leaves && !enters) continue;
    if (dot(a, facet_area(mesh, i)) / dot(up, facet_area(mesh, i)) > 0)
      crossings += leaves ? 1 : -1;
  }
  return crossings;
}

// The ship paper's Table 3 has 16 m2 of hot wall.
TEST(MeshGeometry, FrigateShowsSixteenSquareMetresOfHotWall) {
  const Mesh mesh = generate_mesh({"frigate", 2000}).value();
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform;
  constexpr int samples =
      400;  // a facet of 1.4 m2, half of it hidden: 0.035 m2 of spread, 50 facets
  double exposed_m2 = 0;
  for (std::size_t i = 0; i < mesh.triangle.size(); ++i) {
    const std::string& group = mesh.group[mesh.triangle_group[i]];
    if (group != "funnel_top" && group != "mast_hot") continue;
    const auto& t = mesh.triangle[i];
    const Vec<Body> area = facet_area(mesh, i);
    int outside = 0;
    for (int k = 0; k < samples; ++k) {
      const double root = std::sqrt(uniform(random)), part = uniform(random);
      const Vec<Body> p = (1 - root) * mesh.vertex[t[0]] + root * (1 - part) * mesh.vertex[t[1]] +
                          root * part * mesh.vertex[t[2]] + 1e-6 * normalized(area);
      if (solids_around(mesh, p) == 0) ++outside;
    }
    exposed_m2 += length(area) * outside / samples;
  }
  EXPECT_NEAR(exposed_m2, 16, 0.3);
}

}  // namespace
}  // namespace irsig
