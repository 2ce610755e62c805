#include "core/scene/mesh_measure.h"

#include <algorithm>
#include <limits>

namespace irsig {
namespace {

Vec<Body> double_area(const Mesh& mesh, const std::array<std::uint32_t, 3>& t) {
  return cross(mesh.vertex[t[1]] - mesh.vertex[t[0]], mesh.vertex[t[2]] - mesh.vertex[t[0]]);
}

// An edge as (lower vertex, higher vertex), and whether the triangle runs down it.
struct Edge {
  std::uint64_t key;
  bool down;
  friend bool operator<(const Edge& a, const Edge& b) {
    return a.key != b.key ? a.key < b.key : a.down < b.down;
  }
};

std::uint64_t count_open_edges(const Mesh& mesh) {
  std::vector<Edge> edge;
  edge.reserve(3 * mesh.triangle.size());
  for (const auto& t : mesh.triangle) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint64_t a = t[i], b = t[(i + 1) % 3];
      edge.push_back({std::min(a, b) << 32 | std::max(a, b), a > b});
    }
  }
  std::sort(edge.begin(), edge.end());
  std::uint64_t open = 0;
  for (std::size_t i = 0; i < edge.size();) {
    std::size_t end = i;
    while (end < edge.size() && edge[end].key == edge[i].key) ++end;
    if (end - i != 2 || edge[i].down == edge[i + 1].down) ++open;
    i = end;
  }
  return open;
}

}  // namespace

MeshMeasure measure(const Mesh& mesh) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  MeshMeasure out;
  out.group_area_m2.resize(mesh.group.size());
  out.box_min = {infinity, infinity, infinity};
  out.box_max = {-infinity, -infinity, -infinity};
  for (std::size_t i = 0; i < mesh.triangle.size(); ++i) {
    const auto& t = mesh.triangle[i];
    const Vec<Body> normal = double_area(mesh, t);
    const double area_m2 = 0.5 * length(normal);
    out.area_m2 += area_m2;
    out.group_area_m2[mesh.triangle_group[i]] += area_m2;
    out.volume_m3 += dot(mesh.vertex[t[0]], normal) / 6;
    for (const std::uint32_t index : t) {
      const Vec<Body>& v = mesh.vertex[index];
      out.box_min = {std::min(out.box_min.x, v.x), std::min(out.box_min.y, v.y),
                     std::min(out.box_min.z, v.z)};
      out.box_max = {std::max(out.box_max.x, v.x), std::max(out.box_max.y, v.y),
                     std::max(out.box_max.z, v.z)};
    }
  }
  out.open_edges = count_open_edges(mesh);
  return out;
}

std::uint64_t count_degenerate(const Mesh& mesh) {
  std::uint64_t count = 0;
  for (const auto& t : mesh.triangle) {
    double longest_squared = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec<Body> edge = mesh.vertex[t[i]] - mesh.vertex[t[(i + 1) % 3]];
      longest_squared = std::max(longest_squared, dot(edge, edge));
    }
    if (length(double_area(mesh, t)) <= 1e-12 * longest_squared) ++count;
  }
  return count;
}

}  // namespace irsig
