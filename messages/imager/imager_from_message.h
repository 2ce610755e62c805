#pragma once

#include "absl/status/statusor.h"
#include "core/imager/imager.h"
#include "schema/imager.pb.h"

namespace irsig {

// Converts the keys of an imager file or of [imager] of a sweep, and writes out the defaults of
// docs/reference/imager.md. INVALID_ARGUMENT, with the key: a number that no camera can have, or no
// gain. Messages that `check_imager` (jobs/files/imager_file.h) accepts are converted; others come
// from damaged databases.
[[nodiscard]] absl::StatusOr<Imager> imager_from_message(const schema::ImagerFile& stated);

}  // namespace irsig
