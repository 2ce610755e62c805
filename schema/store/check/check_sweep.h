#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "schema/job.pb.h"

namespace irsig {

// Checks that a sweep can be stored. It has a name, viewpoints, conditions, bands and parts without
// duplicates. No name has control characters or invalid UTF-8, because names are printed. The jobs
// cover every place (viewpoint x condition x band) exactly once. INVALID_ARGUMENT otherwise.
[[nodiscard]] absl::Status check_sweep(const schema::ResolvedSweep& sweep,
                                       const std::string& sweep_sha256,
                                       const std::vector<schema::JobSpec>& jobs);

}  // namespace irsig
