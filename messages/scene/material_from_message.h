#pragma once

#include "absl/status/statusor.h"
#include "core/materials/material_spec.h"
#include "schema/sweep.pb.h"

namespace irsig {

// A [[material]] of a resolved sweep, which names no file and no entry of the library any more.
// INVALID_ARGUMENT for a kind that is not known.
[[nodiscard]] absl::StatusOr<MaterialSpec> material_from_message(const schema::Material& material);

}  // namespace irsig
