#pragma once

#include "absl/status/statusor.h"
#include "jobs/text/sweep_file.h"

namespace irsig {

// The materials of a sweep file alone, checked and written out as resolve_sweep does it, those of
// the library that its parts name included: to look at one while the rest of the file is not ready.
// Errors as those of resolve_sweep.
[[nodiscard]] absl::StatusOr<std::vector<schema::Material>> resolved_materials(
    const SweepFile& file);

}  // namespace irsig
