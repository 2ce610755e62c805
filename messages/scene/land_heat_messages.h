#pragma once

#include <cstddef>
#include <vector>

#include "absl/status/statusor.h"
#include "core/land/land_kinds.h"
#include "core/thermal/land/land_heat.h"
#include "schema/result.pb.h"
#include "schema/sweep.pb.h"

namespace irsig {

// Conversions of computed temperatures of land: kinds and their temperatures at each time.

// Returns which materials of [land] have kinds of their own: those with a build_up. [material]
[[nodiscard]] std::vector<bool> land_computed(const schema::Sweep& sweep);
// Returns which materials objects on the land may have. [material]
[[nodiscard]] std::vector<bool> land_on_objects(const schema::Sweep& sweep);

// Converts temperatures of land to a message. by_time: a result for each time of the field.
[[nodiscard]] schema::LandHeat land_heat_to_message(const LandKinds& kinds,
                                                    const LandHeatResult& by_time);

// Converts kinds of land without held_out, and indexes them; every horizon that at() can take
// exists. INVALID_ARGUMENT: sizes do not fit, numbers are not finite or out of range, or kinds have
// materials that the sweep does not have or compute.
[[nodiscard]] absl::StatusOr<LandKinds> land_kinds_from_message(const schema::LandKinds& message,
                                                                const schema::Sweep& sweep);

struct LandHeat {
  LandKinds kinds;
  LandHeatResult by_time;
};
// Converts temperatures of land, with the same errors; each kind must have `times` temperatures.
[[nodiscard]] absl::StatusOr<LandHeat> land_heat_from_message(const schema::LandHeat& message,
                                                              const schema::Sweep& sweep,
                                                              std::size_t times);

}  // namespace irsig
