#pragma once

#include <cstdint>

#include "absl/status/statusor.h"
#include "core/scene/mesh.h"

namespace irsig {

// The same surface with no edge longer than longest_m: edges are halved, whatever facets meet
// there, until none is. Facets keep their group and their side; the pieces of one follow each
// other. INVALID_ARGUMENT where more than most_facets would come out.
[[nodiscard]] absl::StatusOr<Mesh> cut_long_edges(const Mesh& mesh, double longest_m,
                                                  std::uint64_t most_facets);

}  // namespace irsig
