#pragma once

#include "absl/status/statusor.h"
#include "jobs/text/sweep_file.h"

namespace irsig {

// Checks and resolves the materials of a sweep file alone, as resolve_sweep does, including library
// materials that parts name. A user can thus inspect one material while the rest of the file is
// unfinished. Errors: those of resolve_sweep.
[[nodiscard]] absl::StatusOr<std::vector<schema::Material>> resolved_materials(
    const SweepFile& file);

}  // namespace irsig
