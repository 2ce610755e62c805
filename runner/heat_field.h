#pragma once

#include <cstddef>

#include "absl/status/statusor.h"
#include "core/land/land_scene.h"
#include "schema/assets.h"
#include "schema/job.pb.h"
#include "schema/result.pb.h"

namespace irsig {

// The temperatures of ResolvedSweep.heat[run]: of each facet of the sweep's mesh whose part states
// none (HeatRun.part_temperature_k is 0), at each time wanted, with their errors; of these parts,
// by area; and of the land's kinds if the run computes land. A function of what the job's key
// covers (jobs/keys/expand.h) and of nothing else. land: of land_from_sweep; null: it is read where
// it is needed. INVALID_ARGUMENT: what the sweep's author can mend, by the key's path.
[[nodiscard]] absl::StatusOr<schema::HeatJobResult> compute_heat(const schema::ResolvedSweep& sweep,
                                                                 const Assets& assets,
                                                                 std::size_t run,
                                                                 const LandScene* land = nullptr);

}  // namespace irsig
