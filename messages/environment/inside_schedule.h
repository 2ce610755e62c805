#pragma once

#include <optional>

#include "absl/status/statusor.h"
#include "core/thermal/day_schedule.h"
#include "schema/sweep.pb.h"

namespace irsig {

// Returns the daily schedule of a resolved build-up's inner side: temperature in K, or, for inside
// = "heat_flux", heat into the wall in W/m2. nullopt: it has no schedule. INVALID_ARGUMENT: times
// that are none, or not in their order.
[[nodiscard]] absl::StatusOr<std::optional<DaySchedule>> inside_schedule(
    const schema::BuildUp& build_up);

}  // namespace irsig
