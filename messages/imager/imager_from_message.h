#pragma once

#include "absl/status/statusor.h"
#include "core/imager/imager.h"
#include "schema/imager.pb.h"

namespace irsig {

// Converts an imager file's keys, or those of [imager] of a sweep, and writes out the defaults of
// docs/reference/imager.md.
// INVALID_ARGUMENT, with the key: a number that no camera can have, or no gain. A message that
// `check_imager` (jobs/files/imager_file.h) accepts is converted; others come from damaged databases.
[[nodiscard]] absl::StatusOr<Imager> imager_from_message(const schema::ImagerFile& stated);

}  // namespace irsig
