#pragma once

#include <functional>

#include "absl/status/status.h"
#include "schema/job.pb.h"

namespace irsig {

// Checks a resolved sweep that comes from elsewhere. A program's main passes check_resolved
// (jobs/check_resolved.h) to those who take sweeps from others, so that they need not link what it
// takes to judge one. INVALID_ARGUMENT: as check_resolved.
using SweepCheck = std::function<absl::Status(const schema::ResolvedSweep&)>;

}  // namespace irsig
