#pragma once

#include "absl/status/statusor.h"
#include "schema/assets.h"
#include "schema/job.pb.h"

namespace irsig {

// Computes the outputs of the sweep's heat runs, in their order, in this process. None of a sweep
// without heat runs.
[[nodiscard]] absl::StatusOr<HeatOutputs> heat_outputs(const schema::ResolvedSweep& sweep,
                                                       const Assets& assets);

}  // namespace irsig
