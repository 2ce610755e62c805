#pragma once

#include "absl/status/statusor.h"
#include "core/scene/mesh.h"
#include "schema/assets.h"

namespace irsig {

// The sweep's model, imported or generated, where it lies; of a sweep whose temperatures are
// computed cut at the surface below it, but for temperature fields that count facets, and to
// heat.element_size_m.
[[nodiscard]] absl::StatusOr<Mesh> model_mesh(const schema::ResolvedSweep& sweep,
                                              const Assets& assets);

// Returns the facets of model_mesh() before the model is placed: for a file in its own units, as if
// its axes were +x forward and +z up.
[[nodiscard]] absl::StatusOr<Mesh> model_mesh_of_file(const schema::ResolvedSweep& sweep,
                                                      const Assets& assets);

}  // namespace irsig
