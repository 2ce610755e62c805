#pragma once

#include <cstddef>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/assets.h"
#include "schema/job.pb.h"

namespace irsig {

// Returns one sigma of the heat model's error in each facet's computed temperature under a
// condition [facet] [K]. It is the root sum of squares of the changes by the keys of [uncertainty]
// that belong to the model (is_of_heat_model). NaN: the facet's temperature is not computed. Empty:
// the sweep did not request this error.
//   heat  outputs of the sweep's heat runs
// INVALID_ARGUMENT: an output is of another mesh or lacks the condition's time.
[[nodiscard]] absl::StatusOr<std::vector<double>> heat_model_error_k(
    const schema::ResolvedSweep& sweep, const HeatOutputs& heat, const schema::Condition& condition,
    std::size_t facets);

}  // namespace irsig
