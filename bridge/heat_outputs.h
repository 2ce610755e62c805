#pragma once

#include <cstddef>
#include <string>

#include "absl/status/statusor.h"
#include "schema/assets.h"
#include "schema/job.pb.h"
#include "schema/result.pb.h"

namespace irsig {

// Computes the outputs of the sweep's heat runs, in their order, in this process. None of a sweep
// without heat runs.
[[nodiscard]] absl::StatusOr<HeatOutputs> heat_outputs(const schema::ResolvedSweep& sweep,
                                                       const Assets& assets);

// Reads a heat job's output for so many facets. INVALID_ARGUMENT: the bytes are no output, or that
// of another mesh.
[[nodiscard]] absl::StatusOr<schema::HeatField> read_heat_field(const std::string& bytes,
                                                                std::size_t facets);

}  // namespace irsig
