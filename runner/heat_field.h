#pragma once

#include <cstddef>

#include "absl/status/statusor.h"
#include "core/land/land_scene.h"
#include "schema/assets.h"
#include "schema/job.pb.h"
#include "schema/result.pb.h"

namespace irsig {

// Computes the temperatures of ResolvedSweep.heat[run] and their errors. They are the temperatures
// of each facet of the sweep's mesh whose part states none (HeatRun.part_temperature_k is 0), at
// each requested time; the area means of these parts; and, if the run computes land, of the land's
// kinds. The result depends only on fields that the job's key covers (jobs/keys/expand.h). land:
// from land_from_sweep; null: read when needed. INVALID_ARGUMENT: errors that the sweep's author
// can correct, by the key's path.
[[nodiscard]] absl::StatusOr<schema::HeatJobResult> compute_heat(const schema::ResolvedSweep& sweep,
                                                                 const Assets& assets,
                                                                 std::size_t run,
                                                                 const LandScene* land = nullptr);

}  // namespace irsig
