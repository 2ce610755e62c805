#pragma once

#include "absl/status/statusor.h"
#include "core/materials/material_spec.h"
#include "schema/sweep.pb.h"

namespace irsig {

// Converts a [[material]] of a resolved sweep, which names no file and no library entry.
// INVALID_ARGUMENT: an unknown kind.
[[nodiscard]] absl::StatusOr<MaterialSpec> material_from_message(const schema::Material& material);

}  // namespace irsig
