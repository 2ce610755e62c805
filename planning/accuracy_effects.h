#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/assets.h"
#include "schema/job.pb.h"
#include "view/study_tables/accuracy_tables.h"

namespace irsig {

struct EffectsCurves {
  std::vector<WorkMeasurement> work;  // kAutomatic, kAllEffects: a point for each asked error
  std::vector<LeftOutEffects> left_out;
};

// One row of a sweep computed as a sweep of this one row would be: with the effects that the
// asked error calls for, and with all effects; 10 % to 0.03 %, as far as the budget goes.
[[nodiscard]] absl::StatusOr<EffectsCurves> effects_curves(
    const schema::ResolvedSweep& sweep, const Assets& assets, const HeatOutputs& heat,
    const Viewpoint& viewpoint, std::uint32_t condition, std::uint32_t band,
    const ReferenceValue& reference, WorkBudget budget, const CpuClock& cpu_s);

}  // namespace irsig
