#pragma once

#include <cstdint>
#include <vector>

#include "core/scene/check/mesh_topology.h"

namespace irsig {

struct FacetCrossing {
  std::uint32_t facet, other;  // facet < other
  bool coplanar;               // they cover each other in part; else one pierces the other
};
// Facets that share no place and meet: an edge of one passes through the inside of the other
// (decided by exact arithmetic; edges that only touch at an end, to 1e-9 of their length, do not
// count), or they lie in one plane to 1e-9 of their size and cover each other.
[[nodiscard]] std::vector<FacetCrossing> facet_crossings(const Mesh& mesh,
                                                         const MeshTopology& topology);

}  // namespace irsig
