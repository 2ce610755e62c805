#pragma once

#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/problems.h"
#include "jobs/text/sweep_file.h"
#include "schema/job.pb.h"

namespace irsig {

// Checks the meaning and writes out every default, the viewpoints and the conditions. All errors at
// once, in the order of the file. A pure function: whoever calls it has read the model file
// (model.file is relative to the sweep file). model_bytes: the model file's content (ignored for
// generated models).
// warnings, unless it is null: what is possible but odd, at its keys; each is also in
// Condition.warning of the conditions that it is about.
[[nodiscard]] absl::StatusOr<schema::ResolvedSweep> resolve_sweep(
    const SweepFile& file, std::string_view model_bytes, std::vector<Problem>* warnings = nullptr);

}  // namespace irsig
