#pragma once

#include "absl/status/statusor.h"
#include "core/environment/surroundings.h"
#include "schema/job.pb.h"

namespace irsig {

// Returns the surroundings of a condition without the embedded atmosphere. INVALID_ARGUMENT: an
// unknown kind.
[[nodiscard]] absl::StatusOr<Surroundings> surroundings_from_message(
    const schema::Surroundings& message);

}  // namespace irsig
