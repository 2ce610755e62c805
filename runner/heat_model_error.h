#pragma once

#include <cstddef>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/assets.h"
#include "schema/job.pb.h"

namespace irsig {

// Returns one sigma of the model of heat of each facet's computed temperature under a condition:
// the root of the sum of squares of the changes by the keys of [uncertainty] that are the model's
// (is_of_heat_model). NaN: the facet's temperature is not computed. Empty: the sweep did not ask
// for it. [facet] [K]
//   heat  outputs of the sweep's heat runs
// INVALID_ARGUMENT: an output is of another mesh or lacks the condition's time.
[[nodiscard]] absl::StatusOr<std::vector<double>> heat_model_error_k(
    const schema::ResolvedSweep& sweep, const HeatOutputs& heat, const schema::Condition& condition,
    std::size_t facets);

}  // namespace irsig
