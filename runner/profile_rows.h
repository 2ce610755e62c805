#pragma once

#include "absl/status/status.h"
#include "core/signature/simulator.h"
#include "schema/job.pb.h"
#include "schema/result.pb.h"

namespace irsig {

// Measures every [[profile]] of the sweep under the conditions and in the bands of the request, and
// adds the rows to those of `result`, which has one for each condition and band. Rays and ordinary
// guarded events are added to its counts. Fails if check_numbers refuses the profiles' numbers.
[[nodiscard]] absl::Status add_profile_rows(const schema::ResolvedSweep& sweep,
                                            const Simulator& simulator, const ViewRequest& request,
                                            schema::JobResult& result);

}  // namespace irsig
