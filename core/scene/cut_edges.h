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

// Returns the same surface with no edge longer than longest_m: edges are halved, whatever facets
// meet there, until none is. Facets keep their group and their side; the pieces of one follow each
// other. `made` gets the vertices after the mesh's own. INVALID_ARGUMENT if the result would have
// more than most_facets.
[[nodiscard]] absl::StatusOr<Mesh> cut_long_edges(const Mesh& mesh, double longest_m,
                                                  std::uint64_t most_facets,
                                                  std::vector<CutVertex>& made);

// Returns the same surface with no facet on both sides of z = 0 by more than touching_m. Groups,
// sides and `made` are as for cut_long_edges().
[[nodiscard]] Mesh cut_at_surface(const Mesh& mesh, double touching_m,
                                  std::vector<CutVertex>& made);

// Adds the vertices that cuts have made to those of the same mesh in other coordinates.
void add_cut_vertices(const std::vector<CutVertex>& made, std::vector<Vec<Body>>& vertex);

}  // namespace irsig
