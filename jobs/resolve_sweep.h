#pragma once

#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/problems.h"
#include "jobs/text/sweep_file.h"
#include "schema/job.pb.h"

namespace irsig {

// Checks the meaning of a sweep and writes out every default, the viewpoints and the conditions.
// Reports all errors at once, in the order of the file. A pure function: the caller has read the
// model file (model.file is relative to the sweep file).
//   model_bytes  content of the model file; ignored for generated models
//   warnings     unless null: receives possible but odd values, at their keys; each is also in
//                Condition.warning of the conditions concerned
[[nodiscard]] absl::StatusOr<schema::ResolvedSweep> resolve_sweep(
    const SweepFile& file, std::string_view model_bytes, std::vector<Problem>* warnings = nullptr);

}  // namespace irsig
