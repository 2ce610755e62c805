#pragma once

#include "absl/status/statusor.h"
#include "core/scene/mesh.h"
#include "schema/assets.h"

namespace irsig {

// The sweep's model, imported or generated, where it lies.
[[nodiscard]] absl::StatusOr<Mesh> model_mesh(const schema::ResolvedSweep& sweep,
                                              const Assets& assets);

}  // namespace irsig
