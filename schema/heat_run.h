#pragma once

#include "schema/job.pb.h"

namespace irsig {

// Returns true if the job of a run computes temperatures of parts, or changes of them by inputs.
[[nodiscard]] bool computes_parts(const schema::HeatRun& run);

// Returns true if the job of a run computes temperatures of land. Runs of changes compute none.
[[nodiscard]] bool computes_land(const schema::HeatRun& run);

// Returns true if the job of a run of changes computes those of the temperatures of land.
[[nodiscard]] bool changes_land(const schema::HeatRun& run);

}  // namespace irsig
