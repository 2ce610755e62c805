#pragma once

#include <memory>
#include <string>
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

// Returns the temperatures with an input moved.
//   moved  the sweep with the move; its conditions have the stated temperatures as moved
// INVALID_ARGUMENT: changes that are damaged, or of other kinds.
[[nodiscard]] absl::StatusOr<LandTemperatures> moved_land_temperatures(
    const LandTemperatures& nominal, const schema::ResolvedSweep& moved, const HeatOutputs& heat,
    const std::string& input, double move);

}  // namespace irsig
