#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/scene/mesh.h"

namespace irsig {

// A vertex that a cut has made: a share of the way between two others, which come before it.
struct CutVertex {
  std::uint32_t from, to;
  double share;
};

// The same surface with no edge longer than longest_m: edges are halved, whatever facets meet
// there, until none is. Facets keep their group and their side; the pieces of one follow each
// other. `made` gets what comes after the mesh's own vertices. INVALID_ARGUMENT where more than
// most_facets would come out.
[[nodiscard]] absl::StatusOr<Mesh> cut_long_edges(const Mesh& mesh, double longest_m,
                                                  std::uint64_t most_facets,
                                                  std::vector<CutVertex>& made);

// The same surface with no facet on both sides of z = 0 by more than touching_m; likewise.
[[nodiscard]] Mesh cut_at_surface(const Mesh& mesh, double touching_m,
                                  std::vector<CutVertex>& made);

// Adds the vertices that cuts have made to those of the same mesh in other coordinates.
void add_cut_vertices(const std::vector<CutVertex>& made, std::vector<Vec<Body>>& vertex);

}  // namespace irsig
