#include <algorithm>
#include <array>
#include <limits>
#include <set>

#include "core/scene/check/mesh_lint.h"
#include "core/scene/check/mesh_topology.h"
#include "core/scene/mesh_measure.h"

namespace irsig {
namespace {

constexpr std::uint32_t kNoIndex = std::numeric_limits<std::uint32_t>::max();

void turn_over(std::array<std::uint32_t, 3>& t) { std::swap(t[1], t[2]); }

// Facets at their places, without those that are none or that stand twice.
Mesh cleaned(const Mesh& mesh, RepairLog& log) {
  const MeshTopology topology = topology_of(mesh);
  Mesh out;
  out.group = mesh.group;
  std::vector<bool> used(mesh.vertex.size(), false);
  for (const auto& t : mesh.triangle)
    for (const std::uint32_t i : t) used[i] = true;
  std::vector<std::uint32_t> number(mesh.vertex.size(), kNoIndex);
  const auto keep = [&](std::uint32_t i) {
    std::uint32_t& n = number[topology.place_of[i]];
    if (n == kNoIndex) {
      n = static_cast<std::uint32_t>(out.vertex.size());
      out.vertex.push_back(mesh.vertex[i]);
    }
    return n;
  };
  std::set<std::array<std::uint32_t, 3>> seen;
  for (std::size_t f = 0; f < mesh.triangle.size(); ++f) {
    const auto& t = mesh.triangle[f];
    const Vec<Body>&a = mesh.vertex[t[0]], &b = mesh.vertex[t[1]], &c = mesh.vertex[t[2]];
    const double longest = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
    if (length(cross(b - a, c - a)) <= 1e-12 * longest) {
      ++log.dropped_zero_area;
      continue;
    }
    std::array<std::uint32_t, 3> key{};
    for (std::size_t k = 0; k < 3; ++k) key[k] = topology.place_of[t[k]];
    std::rotate(key.begin(), std::min_element(key.begin(), key.end()), key.end());
    if (!seen.insert(key).second) {
      ++log.dropped_duplicates;
      continue;
    }
    out.triangle.push_back({keep(t[0]), keep(t[1]), keep(t[2])});
    out.triangle_group.push_back(mesh.triangle_group[f]);
  }
  for (std::size_t i = 0; i < mesh.vertex.size(); ++i) {
    if (topology.place_of[i] != i && used[i]) ++log.merged_vertices;
    if (!used[i] || (topology.place_of[i] == i && number[i] == kNoIndex)) ++log.dropped_vertices;
  }
  return out;
}

// Winds the facets of each shell alike, beginning with its first one.
void orient(Mesh& mesh, RepairLog& log) {
  const MeshTopology topology = topology_of(mesh);
  std::vector<std::array<std::uint32_t, 3>> neighbour(mesh.triangle.size(),
                                                      {kNoIndex, kNoIndex, kNoIndex});
  std::vector<std::array<bool, 3>> alike(mesh.triangle.size());
  std::vector<std::uint8_t> count(mesh.triangle.size(), 0);
  for_each_edge(topology, [&](const auto* first, const auto* last) {
    if (last - first != 2) return;
    for (int i = 0; i < 2; ++i) {
      const std::uint32_t f = first[i].facet;
      neighbour[f][count[f]] = first[1 - i].facet;
      alike[f][count[f]++] = first[0].down != first[1].down;
    }
  });
  std::vector<std::int8_t> turned(mesh.triangle.size(), -1);
  for (std::uint32_t start = 0; start < mesh.triangle.size(); ++start) {
    if (turned[start] >= 0) continue;
    turned[start] = 0;
    std::vector<std::uint32_t> open{start};
    while (!open.empty()) {
      const std::uint32_t f = open.back();
      open.pop_back();
      for (std::size_t k = 0; k < count[f]; ++k) {
        const std::uint32_t g = neighbour[f][k];
        const auto wanted = static_cast<std::int8_t>(alike[f][k] ? turned[f] : 1 - turned[f]);
        if (turned[g] < 0) {
          turned[g] = wanted;
          open.push_back(g);
        } else if (turned[g] != wanted && g > f) {
          ++log.unorientable_edges;
        }
      }
    }
  }
  for (std::size_t f = 0; f < mesh.triangle.size(); ++f)
    if (turned[f] == 1) turn_over(mesh.triangle[f]);
  // Shells that are now inside out as a whole.
  const MeshTopology wound = topology_of(mesh);
  const std::vector<bool> inside_out = shells_inside_out(mesh, wound);
  for (std::size_t f = 0; f < mesh.triangle.size(); ++f) {
    if (wound.shell_of[f] == MeshTopology::kNone || !inside_out[wound.shell_of[f]]) continue;
    turn_over(mesh.triangle[f]);
    turned[f] = turned[f] == 1 ? 0 : 1;
  }
  log.turned_facets =
      static_cast<std::uint64_t>(std::count(turned.begin(), turned.end(), std::int8_t{1}));
}

}  // namespace

RepairedMesh repair(const Mesh& mesh) {
  RepairedMesh out;
  out.mesh = cleaned(mesh, out.log);
  orient(out.mesh, out.log);
  out.mesh.degenerate_triangles = count_degenerate(out.mesh);
  return out;
}

}  // namespace irsig
