#pragma once

#include "absl/status/statusor.h"
#include "core/thermal/scene/heat_knots.h"
#include "schema/job.pb.h"

namespace irsig {

// Returns the weather of a HeatRun at the knots of its computation (heat_knots.h).
[[nodiscard]] absl::StatusOr<HeatKnots> heat_weather(const schema::Sweep& sweep,
                                                     const schema::HeatRun& heat);

}  // namespace irsig
