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

// by_time: an output for each time of the field.
[[nodiscard]] schema::LandHeat land_heat_to_message(const LandKinds& kinds,
                                                    const LandHeatResult& by_time);

// Without held_out, indexed: every horizon that at() can take exists.
// INVALID_ARGUMENT: sizes that do not fit, numbers that are not finite or out of range, kinds of
// other materials than the sweep has or computes.
[[nodiscard]] absl::StatusOr<LandKinds> land_kinds_from_message(const schema::LandKinds& message,
                                                                const schema::Sweep& sweep);

struct LandHeat {
  LandKinds kinds;
  LandHeatResult by_time;
};
// Likewise; with temperatures of each kind at so many times.
[[nodiscard]] absl::StatusOr<LandHeat> land_heat_from_message(const schema::LandHeat& message,
                                                              const schema::Sweep& sweep,
                                                              std::size_t times);

}  // namespace irsig
