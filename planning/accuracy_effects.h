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

// Computes one row of a sweep as a sweep of this row alone would: with the effects that the
// requested error needs, and with all effects. Requested errors fall from 10 % to 0.03 %, as far as
// the budget allows.
[[nodiscard]] absl::StatusOr<EffectsCurves> effects_curves(
    const schema::ResolvedSweep& sweep, const Assets& assets, const HeatOutputs& heat,
    const Viewpoint& viewpoint, std::uint32_t condition, std::uint32_t band,
    const ReferenceValue& reference, WorkBudget budget, const CpuClock& cpu_s);

}  // namespace irsig
