#pragma once

#include "absl/status/statusor.h"
#include "core/plume/exhaust_gas.h"
#include "core/plume/plume_grids.h"
#include "schema/job.pb.h"

namespace irsig {

// Returns the meaning of a file's grids by [plume]. Not checked: check_plume_grids.
// INVALID_ARGUMENT: an unknown interpolation.
[[nodiscard]] absl::StatusOr<PlumeGrids> grids_from_message(const schema::Plume& plume);

// Returns the properties of a funnel's fuel.
[[nodiscard]] ExhaustSpec exhaust_from_message(const schema::Plume& plume);

// Returns the plume's position in the body frame.
[[nodiscard]] Vec<Body> position_of(const schema::Plume& plume);

}  // namespace irsig
