#pragma once

#include "absl/status/statusor.h"
#include "core/plume/exhaust_gas.h"
#include "core/plume/plume_grids.h"
#include "schema/job.pb.h"

namespace irsig {

// What [plume] says of a file's grids. Not checked: check_plume_grids. INVALID_ARGUMENT: an
// interpolation that is none.
[[nodiscard]] absl::StatusOr<PlumeGrids> grids_from_message(const schema::Plume& plume);

// What it says of a funnel's fuel.
[[nodiscard]] ExhaustSpec exhaust_from_message(const schema::Plume& plume);

// Where it is, in the body frame.
[[nodiscard]] Vec<Body> position_of(const schema::Plume& plume);

}  // namespace irsig
