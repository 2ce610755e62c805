#pragma once

#include <cstddef>
#include <string>

#include "absl/status/statusor.h"
#include "schema/assets.h"
#include "schema/job.pb.h"
#include "schema/result.pb.h"

namespace irsig {

// Of the sweep's heat runs, in their order, computed here. None of a sweep without.
[[nodiscard]] absl::StatusOr<HeatOutputs> heat_outputs(const schema::ResolvedSweep& sweep,
                                                       const Assets& assets);

// What a heat job has left, read: of so many facets. INVALID_ARGUMENT: the bytes are none, or of
// another mesh.
[[nodiscard]] absl::StatusOr<schema::HeatField> read_heat_field(const std::string& bytes,
                                                                std::size_t facets);

}  // namespace irsig
