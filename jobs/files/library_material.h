#pragma once

#include "absl/status/statusor.h"
#include "core/materials/material_spec.h"
#include "schema/sweep.pb.h"

namespace irsig {

// A material as the [[material]] table that means the same, with its kind and all its numbers
// inline: how an entry of the material library becomes part of a sweep. (The way back is
// messages/scene/material_from_message.h.) Masking that a sweep file cannot ask for is
// INVALID_ARGUMENT.
[[nodiscard]] absl::StatusOr<schema::Material> message_of(const MaterialSpec& spec);

}  // namespace irsig
