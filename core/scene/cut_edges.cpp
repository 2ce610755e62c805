#include "core/scene/cut_edges.h"

#include <algorithm>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"

namespace irsig {

namespace {

Vec<Body> between(const std::vector<Vec<Body>>& vertex, const CutVertex& v) {
  return (1 - v.share) * vertex[v.from] + v.share * vertex[v.to];
}

// Makes one round: cuts each edge once where `fraction_of` returns a fraction in (0, 1), else not.
// The fraction counts from the edge's higher vertex to its lower one, so that it is the same
// whichever facet asks, also where a file has a vertex twice. Returns true if any edge was cut.
template <typename ShareOf>
bool cut_once(const ShareOf& fraction_of, Mesh& mesh, std::vector<CutVertex>& made) {
  absl::flat_hash_map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> cut_of;
  const auto cut_at = [&](std::uint32_t a, std::uint32_t b) -> std::int64_t {
    const double above = mesh.vertex[b].z - mesh.vertex[a].z;  // z is down
    if (above < 0 || (above == 0 && b < a)) std::swap(a, b);
    const double share = fraction_of(mesh.vertex[a], mesh.vertex[b]);
    if (share == 0) return -1;
    const auto [at, is_new] =
        cut_of.try_emplace(std::pair{a, b}, static_cast<std::uint32_t>(mesh.vertex.size()));
    if (is_new) mesh.vertex.push_back(between(mesh.vertex, made.emplace_back(a, b, share)));
    return at->second;
  };
  std::vector<std::array<std::uint32_t, 3>> triangle;
  std::vector<std::uint32_t> group;
  for (std::size_t f = 0; f < mesh.triangle.size(); ++f) {
    std::array<std::uint32_t, 3> c = mesh.triangle[f];
    std::array<std::int64_t, 3> m{};  // of the edge from corner i to the next
    for (std::size_t i = 0; i < 3; ++i) m[i] = cut_at(c[i], c[(i + 1) % 3]);
    const auto add = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
      triangle.push_back({x, y, z});
      group.push_back(mesh.triangle_group[f]);
    };
    const auto cut = std::count_if(m.begin(), m.end(), [](std::int64_t x) { return x >= 0; });
    if (cut == 0) {
      add(c[0], c[1], c[2]);
      continue;
    }
    // One cut: the first edge; two: all but the last.
    const auto turned = [&] { return cut == 1 ? m[0] >= 0 : cut == 2 ? m[2] < 0 : true; };
    while (!turned()) {
      std::rotate(c.begin(), c.begin() + 1, c.end());
      std::rotate(m.begin(), m.begin() + 1, m.end());
    }
    const auto at = [&](std::size_t i) { return static_cast<std::uint32_t>(m[i]); };
    if (cut == 1) {
      add(c[0], at(0), c[2]);
      add(at(0), c[1], c[2]);
    } else if (cut == 2) {
      add(at(0), c[1], at(1));
      add(c[0], at(0), at(1));
      add(c[0], at(1), c[2]);
    } else {
      add(c[0], at(0), at(2));
      add(at(0), c[1], at(1));
      add(at(2), at(1), c[2]);
      add(at(0), at(1), at(2));
    }
  }
  if (cut_of.empty()) return false;
  mesh.triangle = std::move(triangle);
  mesh.triangle_group = std::move(group);
  return true;
}

}  // namespace

absl::StatusOr<Mesh> cut_long_edges(const Mesh& mesh, double longest_m, std::uint64_t most_facets,
                                    std::vector<CutVertex>& made) {
  Mesh out = mesh;
  while (cut_once(
      [&](const Vec<Body>& a, const Vec<Body>& b) { return length(b - a) > longest_m ? 0.5 : 0.0; },
      out, made)) {
    if (out.triangle.size() > most_facets)
      return absl::InvalidArgumentError(absl::StrCat("edges of at most ", longest_m,
                                                     " m make more than ", most_facets,
                                                     " facets, expected a larger size"));
  }
  return out;
}

Mesh cut_at_surface(const Mesh& mesh, double touching_m, std::vector<CutVertex>& made) {
  Mesh out = mesh;
  cut_once(
      [&](const Vec<Body>& a, const Vec<Body>& b) {
        return a.z < -touching_m && b.z > touching_m ? a.z / (a.z - b.z) : 0.0;
      },
      out, made);
  return out;
}

void add_cut_vertices(const std::vector<CutVertex>& made, std::vector<Vec<Body>>& vertex) {
  for (const CutVertex& v : made) vertex.push_back(between(vertex, v));
}

}  // namespace irsig
