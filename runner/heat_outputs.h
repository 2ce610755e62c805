#pragma once

#include "absl/status/statusor.h"
#include "schema/assets.h"
#include "schema/job.pb.h"

namespace irsig {

// Of the sweep's heat runs, in their order, computed here. None of a sweep without.
[[nodiscard]] absl::StatusOr<HeatOutputs> heat_outputs(const schema::ResolvedSweep& sweep,
                                                       const Assets& assets);

}  // namespace irsig
