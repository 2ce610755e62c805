#pragma once

#include "absl/status/statusor.h"
#include "core/materials/material_spec.h"
#include "schema/sweep.pb.h"

namespace irsig {

// Converts a material of the library to the equivalent [[material]] table, with its kind and all
// its numbers inline; the entry thereby becomes part of a sweep. The inverse is
// messages/scene/material_from_message.h. INVALID_ARGUMENT: masking that a sweep file cannot
// request.
[[nodiscard]] absl::StatusOr<schema::Material> message_of(const MaterialSpec& spec);

}  // namespace irsig
