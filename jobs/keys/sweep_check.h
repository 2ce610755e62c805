#pragma once

#include <functional>

#include "absl/status/status.h"
#include "schema/job.pb.h"

namespace irsig {

// Callback that checks a resolved sweep from another process. A program's main passes
// check_resolved (jobs/check_resolved.h) to code that accepts sweeps, which therefore need not link
// the checks. INVALID_ARGUMENT: as check_resolved.
using SweepCheck = std::function<absl::Status(const schema::ResolvedSweep&)>;

}  // namespace irsig
