#include "core/scene/check/facet_overlap.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/scene/trace/reference_tracer.h"

namespace irsig {
namespace {

constexpr double kTouch = 1e-9;  // of a length: contact, not overlap

using Corners = std::array<Point3, 3>;

Point3 minus(const Point3& a, const Point3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point3 cross(const Point3& a, const Point3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Point3& a, const Point3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double length(const Point3& a) { return std::sqrt(dot(a, a)); }

bool pierces(const Corners& edges_of, const Corners& facet) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Point3& from = edges_of[k];
    const FacetHit hit =
        exact_facet_hit(from, minus(edges_of[(k + 1) % 3], from), facet[0], facet[1], facet[2]);
    if (hit.met && hit.t > kTouch && hit.t < 1 - kTouch && hit.u > kTouch && hit.v > kTouch &&
        hit.u + hit.v < 1 - kTouch)
      return true;
  }
  return false;
}

// Triangles in one plane: they overlap unless an edge of one separates them.
bool covers(const Corners& a, const Corners& b) {
  const Point3 na = cross(minus(a[1], a[0]), minus(a[2], a[0])),
               nb = cross(minus(b[1], b[0]), minus(b[2], b[0]));
  const double la = length(na), lb = length(nb);
  double size = 0;
  for (std::size_t k = 0; k < 3; ++k)
    size =
        std::max({size, length(minus(a[(k + 1) % 3], a[k])), length(minus(b[(k + 1) % 3], b[k]))});
  const double touch = kTouch * size;
  if (la <= touch * touch || lb <= touch * touch) return false;
  for (const Point3& p : b)
    if (std::abs(dot(na, minus(p, a[0]))) > touch * la) return false;
  for (const Point3& p : a)
    if (std::abs(dot(nb, minus(p, b[0]))) > touch * lb) return false;
  const auto separates = [touch](const Corners& t, const Point3& n, double n_length,
                                 const Corners& other) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Point3 edge = minus(t[(k + 1) % 3], t[k]);
      const Point3 inwards = cross(n, edge);
      const double scale = n_length * length(edge);
      double deepest = -touch * scale;
      for (const Point3& p : other) deepest = std::max(deepest, dot(inwards, minus(p, t[k])));
      if (deepest <= touch * scale) return true;
    }
    return false;
  };
  return !separates(a, na, la, b) && !separates(b, nb, lb, a);
}

}  // namespace

std::vector<FacetCrossing> facet_crossings(const Mesh& mesh, const MeshTopology& topology) {
  std::vector<Point3> vertex;
  vertex.reserve(mesh.vertex.size());
  for (const Vec<Body>& v : mesh.vertex) vertex.push_back({v.x, v.y, v.z});
  std::vector<std::uint32_t> triangle;
  triangle.reserve(3 * mesh.triangle.size());
  for (const auto& t : mesh.triangle) triangle.insert(triangle.end(), t.begin(), t.end());
  const auto corners = [&](std::uint32_t f) {
    return Corners{vertex[mesh.triangle[f][0]], vertex[mesh.triangle[f][1]],
                   vertex[mesh.triangle[f][2]]};
  };
  const ReferenceTracer tree(vertex, std::move(triangle));
  std::vector<FacetCrossing> out;
  for (std::uint32_t f = 0; f < mesh.triangle.size(); ++f) {
    if (topology.shell_of[f] == MeshTopology::kNone) continue;
    const Corners a = corners(f);
    Point3 low, high;
    for (std::size_t j = 0; j < 3; ++j) {
      low[j] = std::min({a[0][j], a[1][j], a[2][j]});
      high[j] = std::max({a[0][j], a[1][j], a[2][j]});
    }
    tree.for_touching(low, high, [&](std::uint32_t g) {
      if (g <= f || topology.shell_of[g] == MeshTopology::kNone) return;
      for (const std::uint32_t i : mesh.triangle[f])
        for (const std::uint32_t j : mesh.triangle[g])
          if (topology.place_of[i] == topology.place_of[j]) return;
      const Corners b = corners(g);
      for (std::size_t j = 0; j < 3; ++j)
        if (std::max({b[0][j], b[1][j], b[2][j]}) < low[j] ||
            std::min({b[0][j], b[1][j], b[2][j]}) > high[j])
          return;
      if (covers(a, b))
        out.push_back({f, g, true});
      else if (pierces(a, b) || pierces(b, a))
        out.push_back({f, g, false});
    });
  }
  std::sort(out.begin(), out.end(), [](const FacetCrossing& a, const FacetCrossing& b) {
    return a.facet != b.facet ? a.facet < b.facet : a.other < b.other;
  });
  return out;
}

}  // namespace irsig
