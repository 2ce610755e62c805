#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/scene/mesh.h"

namespace irsig {

// Adjacency of a mesh: the facets that meet at its edges, and the shells that they form.
struct MeshTopology {
  // Index of the first vertex at exactly the same place, for each vertex.
  std::vector<std::uint32_t> place_of;
  // One use of an edge by a facet; sorted by edge.
  struct Use {
    std::uint64_t edge;  // lower place << 32 | higher place
    std::uint32_t facet;
    bool down;  // the facet runs from the higher to the lower place
  };
  std::vector<Use> use;                 // of facets with three different places
  std::vector<std::uint32_t> shell_of;  // by facet; facets without three places have none
  static constexpr std::uint32_t kNone = 0xffffffffu;
  struct Shell {
    std::uint32_t first_facet = 0;
    bool closed = true;    // every edge is used by two facets in opposite directions
    double volume_m3 = 0;  // by the divergence theorem about the shell's first vertex
  };
  std::vector<Shell> shell;
};
[[nodiscard]] MeshTopology topology_of(const Mesh& mesh);

// Calls visit(first, last) for the uses of each edge.
template <typename Visit>
void for_each_edge(const MeshTopology& topology, Visit&& visit) {
  const MeshTopology::Use* at = topology.use.data();
  const MeshTopology::Use* const end = at + topology.use.size();
  while (at != end) {
    const MeshTopology::Use* last = at;
    while (last != end && last->edge == at->edge) ++last;
    visit(at, last);
    at = last;
  }
}

// Returns, for each shell, true if it is closed, has a negative volume and lies inside no other
// shell.
[[nodiscard]] std::vector<bool> shells_inside_out(const Mesh& mesh, const MeshTopology& topology);

}  // namespace irsig
