#pragma once

#include "absl/status/statusor.h"
#include "core/geo/sun.h"
#include "schema/job.pb.h"

namespace irsig {

// Returns the sun's position in one condition, at the target's reference point.
[[nodiscard]] absl::StatusOr<SunPosition> condition_sun(const schema::ResolvedSweep& sweep,
                                                        const schema::Condition& condition);

// Position of the sun in one condition.
struct SunAngles {
  double azimuth_deg, zenith_deg;
};
[[nodiscard]] absl::StatusOr<SunAngles> sun_angles(const schema::ResolvedSweep& sweep,
                                                   const schema::Condition& condition);

}  // namespace irsig
