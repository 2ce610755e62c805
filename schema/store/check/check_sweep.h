#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "schema/job.pb.h"

namespace irsig {

// INVALID_ARGUMENT unless the sweep can be stored: it has a name, viewpoints, conditions, bands and
// parts without duplicates, no name has control characters or bytes that are not UTF-8 (names are
// printed), and its jobs cover every place (viewpoint x condition x band) exactly once.
[[nodiscard]] absl::Status check_sweep(const schema::ResolvedSweep& sweep,
                                       const std::string& sweep_sha256,
                                       const std::vector<schema::JobSpec>& jobs);

}  // namespace irsig
