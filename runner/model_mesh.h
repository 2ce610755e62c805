#pragma once

#include "absl/status/statusor.h"
#include "core/scene/mesh.h"
#include "schema/assets.h"

namespace irsig {

// Returns the sweep's model, imported or generated, at its position. If temperatures are computed,
// its mesh is refined to heat.element_size_m and cut at the surface below the target. The cut at
// the surface is omitted if a temperature field counts facets (match = "index").
[[nodiscard]] absl::StatusOr<Mesh> model_mesh(const schema::ResolvedSweep& sweep,
                                              const Assets& assets);

// Returns the facets of model_mesh() before the model is placed: for a file in its own units, as if
// its axes were +x forward and +z up.
[[nodiscard]] absl::StatusOr<Mesh> model_mesh_of_file(const schema::ResolvedSweep& sweep,
                                                      const Assets& assets);

}  // namespace irsig
