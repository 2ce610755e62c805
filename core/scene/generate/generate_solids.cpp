// Solids of revolution about the x axis, and the box.
//
// How close the number of triangles comes to the asked one (tests/unit/mesh_test.cpp): 2 % from
// 1000 triangles on, 6 % from 200 on; below, the nearest that the shape allows.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/scene/generate/generate_kinds.h"
#include "core/scene/generate/generate_rows.h"
#include "core/scene/mesh_measure.h"

namespace irsig {
namespace {

using std::numbers::pi;

// A ring of `points` vertices at x, evenly spaced on a circle; one point on the axis when radius =
// 0.
struct Ring {
  double x_m, radius_m;
  std::uint64_t points;
};

// Rings from the aft end to the nose; the surface between each two faces outwards.
Mesh revolve(const std::vector<Ring>& rings, const std::string& group) {
  Mesh mesh;
  mesh.group = {group};
  std::vector<std::uint32_t> last, row;
  for (const Ring& ring : rings) {
    row.clear();
    for (std::uint64_t i = 0; i < ring.points; ++i) {
      const double angle_rad = 2 * pi * static_cast<double>(i) / static_cast<double>(ring.points);
      row.push_back(static_cast<std::uint32_t>(mesh.vertex.size()));
      mesh.vertex.push_back(
          {ring.x_m, ring.radius_m * std::cos(angle_rad), ring.radius_m * std::sin(angle_rad)});
    }
    if (ring.points > 1) row.push_back(row.front());
    if (!last.empty()) add_strip(last, row, 0, mesh);
    last.swap(row);
  }
  return mesh;
}

// The corner radius of the regular polygon that has the area of the circle.
double equal_area_radius_m(double radius_m, std::uint64_t points) {
  const double angle_rad = 2 * pi / static_cast<double>(points);
  return radius_m * std::sqrt(angle_rad / std::sin(angle_rad));
}

// The rings of a flat polygon, its centre first, the outer one left out: about points x rings
// triangles together with the strip to the outer one.
std::vector<Ring> cap(double x_m, double corner_m, std::uint64_t points, std::uint64_t rings) {
  std::vector<Ring> out{{x_m, 0, 1}};
  for (std::uint64_t i = 1; i < rings; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(rings);
    const std::uint64_t inner = std::max<std::uint64_t>(
        3, static_cast<std::uint64_t>(std::llround(part * static_cast<double>(points))));
    // The inner ring must lie inside the outer one's sides, also when it has fewer corners.
    out.push_back({x_m, part * corner_m, inner});
  }
  return out;
}

std::uint64_t at_least(std::uint64_t least, double value) {
  return std::max(least, static_cast<std::uint64_t>(std::llround(std::max(value, 0.0))));
}

std::uint64_t triangles_of(const std::vector<Ring>& rings) {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i + 1 < rings.size(); ++i) {
    for (const std::uint64_t points : {rings[i].points, rings[i + 1].points})
      if (points > 1) count += points;
  }
  return count;
}

// Among 0.8 to 1.25 times `guess`, the odd number of points around whose solid comes closest to the
// asked number of triangles. Odd, because the width of a polygon then varies four times less.
template <typename MakeRings>
std::vector<Ring> closest(double guess, std::uint64_t triangles, const MakeRings& make_rings) {
  const std::uint64_t first = at_least(3, std::floor(0.8 * guess)) / 2 * 2 + 1,
                      last = at_least(first, std::ceil(1.25 * guess));
  // Every number for small solids, 200 of them for large ones.
  const std::uint64_t step = 2 * std::max<std::uint64_t>(1, (last - first) / 400);
  std::vector<Ring> best;
  std::uint64_t best_miss = std::numeric_limits<std::uint64_t>::max();
  for (std::uint64_t points = first; points <= last; points += step) {
    std::vector<Ring> rings = make_rings(points);
    const std::uint64_t count = triangles_of(rings);
    const std::uint64_t miss = count > triangles ? count - triangles : triangles - count;
    if (miss >= best_miss) continue;
    best_miss = miss;
    best = std::move(rings);
  }
  return best;
}

}  // namespace

Mesh make_disk(double radius_m, std::uint64_t triangles) {
  const double n = static_cast<double>(triangles);
  const std::uint64_t rings = at_least(1, std::sqrt(n / (2 * pi)));
  const std::vector<Ring> shape =
      closest(n / static_cast<double>(rings), triangles, [&](std::uint64_t points) {
        const double corner_m = equal_area_radius_m(radius_m, points);
        std::vector<Ring> out{{0, corner_m, points}};
        const std::vector<Ring> inner = cap(0, corner_m, points, rings);
        out.insert(out.end(), inner.rbegin(), inner.rend());
        return out;
      });
  return revolve(shape, "disk");
}

Mesh make_cylinder(double radius_m, double length_m, std::uint64_t triangles) {
  // Only the number of points around makes it rounder, so that facets are four times as long as
  // they are wide.
  const double n = static_cast<double>(triangles);
  const double around = std::sqrt(n * 4 * pi * radius_m / (radius_m + length_m));
  const double facet_m = 8 * pi * radius_m / around;
  const std::uint64_t along = at_least(1, length_m / facet_m),
                      rings = at_least(1, radius_m / facet_m);
  const std::vector<Ring> shape =
      closest(n / (2 * static_cast<double>(along + rings)), triangles, [&](std::uint64_t points) {
        const double corner_m = equal_area_radius_m(radius_m, points);
        std::vector<Ring> out = cap(-0.5 * length_m, corner_m, points, rings);
        for (std::uint64_t i = 0; i <= along; ++i) {
          const double x_m = length_m * (static_cast<double>(i) / static_cast<double>(along) - 0.5);
          out.push_back({x_m, corner_m, points});
        }
        const std::vector<Ring> nose = cap(0.5 * length_m, corner_m, points, rings);
        out.insert(out.end(), nose.rbegin(), nose.rend());
        return out;
      });
  return revolve(shape, "cylinder");
}

Mesh make_cone(double radius_m, double length_m, std::uint64_t triangles) {
  // Every ring has the base's number of points: the side is then an exact pyramid.
  const double n = static_cast<double>(triangles), slant_m = std::hypot(radius_m, length_m);
  const double around = std::sqrt(n * 8 * pi * radius_m / (2 * slant_m + radius_m));
  const double facet_m = 8 * pi * radius_m / around;
  const std::uint64_t along = at_least(1, slant_m / facet_m),
                      rings = at_least(1, radius_m / facet_m);
  const std::vector<Ring> shape =
      closest(n / static_cast<double>(2 * along - 1 + rings), triangles, [&](std::uint64_t points) {
        const double corner_m = equal_area_radius_m(radius_m, points);
        std::vector<Ring> out = cap(-0.5 * length_m, corner_m, points, rings);
        for (std::uint64_t i = 0; i < along; ++i) {
          const double part = static_cast<double>(i) / static_cast<double>(along);
          out.push_back({length_m * (part - 0.5), corner_m * (1 - part), points});
        }
        out.push_back({0.5 * length_m, 0, 1});
        return out;
      });
  return revolve(shape, "cone");
}

Mesh make_sphere(double radius_m, std::uint64_t triangles) {
  // Equilateral facets: rings sqrt(3)/2 of a side apart.
  const double n = static_cast<double>(triangles);
  const double equator = std::sqrt(n * pi * std::sqrt(3.0) / 4);
  const std::uint64_t bands = at_least(2, equator / std::sqrt(3.0));
  const auto rings_for = [&](double points_on_equator) {
    std::vector<Ring> out{{-1, 0, 1}};
    for (std::uint64_t i = 1; i < bands; ++i) {
      const double polar_rad = pi * static_cast<double>(i) / static_cast<double>(bands);
      out.push_back({-std::cos(polar_rad), std::sin(polar_rad),
                     at_least(4, points_on_equator * std::sin(polar_rad))});
    }
    out.push_back({1, 0, 1});
    return out;
  };
  double low = 0, high = 4 * equator + 8;  // the count grows with the points on the equator
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (triangles_of(rings_for(middle)) < triangles ? low : high) = middle;
  }
  const std::uint64_t below = triangles_of(rings_for(low)), above = triangles_of(rings_for(high));
  const std::uint64_t miss_above = above > triangles ? above - triangles : triangles - above;
  Mesh mesh = revolve(rings_for(below <= triangles && triangles - below < miss_above ? low : high),
                      "sphere");
  const double scale = radius_m * std::sqrt(4 * pi / measure(mesh).area_m2);
  for (Vec<Body>& v : mesh.vertex) v = scale * v;
  return mesh;
}

Mesh make_box(Vec<Body> size_m, std::uint64_t triangles) {
  const double n = static_cast<double>(triangles);
  const double area_m2 = 2 * (size_m.x * size_m.y + size_m.y * size_m.z + size_m.z * size_m.x);
  const double side_m = std::sqrt(2 * area_m2 / n);
  // Cells a x b x c with 4 (ab + bc + ca) triangles: the nearest number, then the squarest facets.
  struct Cells {
    std::uint64_t a = 1, b = 1, c = 1;
  } best;
  double best_cost = std::numeric_limits<double>::infinity();
  const double ideal[3] = {size_m.x / side_m, size_m.y / side_m, size_m.z / side_m};
  const auto range_end = [](double cells) {
    // A few per cent around the ideal are enough where there are many cells.
    return at_least(1, std::ceil(cells > 60 ? cells + 20 : 1.5 * cells + 1));
  };
  const auto range_begin = [](double cells) {
    return at_least(1, std::floor(cells > 60 ? cells - 20 : 0.6 * cells));
  };
  for (std::uint64_t a = range_begin(ideal[0]); a <= range_end(ideal[0]); ++a) {
    for (std::uint64_t b = range_begin(ideal[1]); b <= range_end(ideal[1]); ++b) {
      const double ab = static_cast<double>(a * b);
      const std::uint64_t c = at_least(1, (n / 4 - ab) / static_cast<double>(a + b));
      const double count = 4 * (ab + static_cast<double>(c * (a + b)));
      double cost = 30 * std::abs(count - n) / n;
      for (const auto& [cells, wanted] : {std::pair(a, ideal[0]), {b, ideal[1]}, {c, ideal[2]}})
        cost += std::abs(std::log(static_cast<double>(cells) / std::max(wanted, 1.0)));
      if (cost >= best_cost) continue;
      best_cost = cost;
      best = {a, b, c};
    }
  }

  Mesh mesh;
  mesh.group = {"box"};
  const auto [a, b, c] = best;
  // Vertices by their place on the lattice; only those on the surface exist.
  std::vector<std::uint32_t> number((a + 1) * (b + 1) * 2 + (a + 1) * 2 * (c + 1) +
                                    2 * (b + 1) * (c + 1));
  const auto slot = [&, na = a, nb = b, nc = c](std::uint64_t i, std::uint64_t j, std::uint64_t k) {
    if (k == 0 || k == nc) return (k == 0 ? 0 : 1) * (na + 1) * (nb + 1) + i * (nb + 1) + j;
    const std::uint64_t first = 2 * (na + 1) * (nb + 1);
    if (j == 0 || j == nb) return first + (j == 0 ? 0 : 1) * (na + 1) * (nc + 1) + i * (nc + 1) + k;
    return first + 2 * (na + 1) * (nc + 1) + (i == 0 ? 0 : 1) * (nb + 1) * (nc + 1) + j * (nc + 1) +
           k;
  };
  const auto place = [](std::uint64_t i, std::uint64_t cells, double extent_m) {
    return extent_m * (static_cast<double>(i) / static_cast<double>(cells) - 0.5);
  };
  for (std::uint64_t i = 0; i <= a; ++i) {
    for (std::uint64_t j = 0; j <= b; ++j) {
      const bool inner = i > 0 && i < a && j > 0 && j < b;
      for (std::uint64_t k = 0; k <= c; k += inner ? c : 1) {
        number[slot(i, j, k)] = static_cast<std::uint32_t>(mesh.vertex.size());
        mesh.vertex.push_back(
            {place(i, a, size_m.x), place(j, b, size_m.y), place(k, c, size_m.z)});
      }
    }
  }
  // One face: rows of u, stacked along v, seen with u to the right and v up from outside.
  const auto face = [&](std::uint64_t nu, std::uint64_t nv, const auto& slot_of) {
    std::vector<std::uint32_t> lower, upper;
    for (std::uint64_t v = 0; v <= nv; ++v) {
      upper.clear();
      for (std::uint64_t u = 0; u <= nu; ++u) upper.push_back(number[slot_of(u, v)]);
      if (v > 0) add_strip(lower, upper, 0, mesh);
      lower.swap(upper);
    }
  };
  using Place = std::uint64_t;
  const Place ea = a, eb = b, ec = c;
  face(eb, ec, [&](Place u, Place v) { return slot(ea, u, v); });  // +x: y right, z up
  face(ec, eb, [&](Place u, Place v) { return slot(0, v, u); });   // -x
  face(ec, ea, [&](Place u, Place v) { return slot(v, eb, u); });  // +y: z right, x up
  face(ea, ec, [&](Place u, Place v) { return slot(u, 0, v); });   // -y
  face(ea, eb, [&](Place u, Place v) { return slot(u, v, ec); });  // +z: x right, y up
  face(eb, ea, [&](Place u, Place v) { return slot(v, u, 0); });   // -z
  return mesh;
}

}  // namespace irsig
