#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/land/land_kinds.h"
#include "schema/assets.h"
#include "schema/job.pb.h"

namespace irsig {

// The temperatures of a sweep's land, where some of them are computed.
struct LandTemperatures {
  std::shared_ptr<const LandKinds> kinds;            // null: none is computed, or all are awaited
  std::vector<std::vector<double>> kelvin, error_k;  // [condition][kind]; empty without kinds
};

// Reads the temperatures of land from the outputs of heat jobs. A stated temperature applies to all
// kinds of its material. heat: outputs of the sweep's heat runs, or empty. INVALID_ARGUMENT: an
// output is damaged, or has no land at a time of a condition. INTERNAL: two runs have different
// kinds.
[[nodiscard]] absl::StatusOr<LandTemperatures> land_temperatures_from_sweep(
    const schema::ResolvedSweep& sweep, const HeatOutputs& heat);

}  // namespace irsig
