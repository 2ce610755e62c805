#include "core/scene/check/mesh_topology.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>

#include "absl/container/flat_hash_map.h"
#include "core/scene/trace/reference_tracer.h"

namespace irsig {
namespace {

std::vector<std::uint32_t> places(const Mesh& mesh) {
  absl::flat_hash_map<std::array<std::uint64_t, 3>, std::uint32_t> at;
  at.reserve(mesh.vertex.size());
  std::vector<std::uint32_t> out;
  out.reserve(mesh.vertex.size());
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x + 0.0); };
  for (const Vec<Body>& v : mesh.vertex)
    out.push_back(
        at.try_emplace({bits(v.x), bits(v.y), bits(v.z)}, static_cast<std::uint32_t>(out.size()))
            .first->second);
  return out;
}

class UnionFind {
 public:
  explicit UnionFind(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace

MeshTopology topology_of(const Mesh& mesh) {
  MeshTopology out;
  out.place_of = places(mesh);
  const auto facets = static_cast<std::uint32_t>(mesh.triangle.size());
  out.use.reserve(3 * std::size_t{facets});
  std::vector<bool> has_three(facets);
  for (std::uint32_t f = 0; f < facets; ++f) {
    std::uint32_t at[3];
    for (std::size_t k = 0; k < 3; ++k) at[k] = out.place_of[mesh.triangle[f][k]];
    has_three[f] = at[0] != at[1] && at[1] != at[2] && at[2] != at[0];
    if (!has_three[f]) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t a = at[k], b = at[(k + 1) % 3];
      out.use.push_back({std::min(a, b) << 32 | std::max(a, b), f, a > b});
    }
  }
  std::sort(out.use.begin(), out.use.end(),
            [](const MeshTopology::Use& a, const MeshTopology::Use& b) {
              return a.edge != b.edge ? a.edge < b.edge : a.facet < b.facet;
            });
  UnionFind joined(facets);
  for_each_edge(out, [&](const auto* first, const auto* last) {
    if (last - first == 2) joined.join(first[0].facet, first[1].facet);
  });
  out.shell_of.assign(facets, MeshTopology::kNone);
  for (std::uint32_t f = 0; f < facets; ++f) {
    if (!has_three[f]) continue;
    const std::uint32_t root = joined.root(f);
    if (root == f) {
      out.shell_of[f] = static_cast<std::uint32_t>(out.shell.size());
      out.shell.push_back({f, true, 0});
    } else {
      out.shell_of[f] = out.shell_of[root];
    }
    MeshTopology::Shell& shell = out.shell[out.shell_of[f]];
    const Vec<Body> o = mesh.vertex[mesh.triangle[shell.first_facet][0]];
    const auto& t = mesh.triangle[f];
    shell.volume_m3 +=
        dot(mesh.vertex[t[0]] - o, cross(mesh.vertex[t[1]] - o, mesh.vertex[t[2]] - o)) / 6;
  }
  for_each_edge(out, [&](const auto* first, const auto* last) {
    if (last - first == 2 && first[0].down != first[1].down) return;
    for (const auto* u = first; u != last; ++u) out.shell[out.shell_of[u->facet]].closed = false;
  });
  return out;
}

std::vector<bool> shells_inside_out(const Mesh& mesh, const MeshTopology& topology) {
  std::vector<bool> out(topology.shell.size(), false);
  const auto negative = [](const MeshTopology::Shell& s) { return s.closed && s.volume_m3 < 0; };
  if (std::none_of(topology.shell.begin(), topology.shell.end(), negative)) return out;
  std::vector<Point3> vertex;
  for (const Vec<Body>& v : mesh.vertex) vertex.push_back({v.x, v.y, v.z});
  std::vector<std::uint32_t> triangle;
  for (const auto& t : mesh.triangle) triangle.insert(triangle.end(), t.begin(), t.end());
  const ReferenceTracer tracer(std::move(vertex), std::move(triangle));
  for (std::size_t s = 0; s < out.size(); ++s) {
    if (!negative(topology.shell[s])) continue;
    // Crossings of the other closed shells on a ray from this one, out less in.
    const auto& t = mesh.triangle[topology.shell[s].first_facet];
    const Vec<Body> from = (1.0 / 3) * (mesh.vertex[t[0]] + mesh.vertex[t[1]] + mesh.vertex[t[2]]);
    int inside = 0;
    for (const ReferenceTracer::Hit& hit :
         tracer.all({from.x, from.y, from.z}, {0.5377, 0.7639, 0.3566}, 0,
                    std::numeric_limits<double>::infinity())) {
      const std::uint32_t other = topology.shell_of[hit.facet];
      if (other == s || other == MeshTopology::kNone || !topology.shell[other].closed) continue;
      // Another shell that is inside out still encloses what lies in it.
      const int sense = topology.shell[other].volume_m3 > 0 ? 1 : -1;
      inside += hit.front ? -sense : sense;
    }
    out[s] = inside <= 0;
  }
  return out;
}

}  // namespace irsig
