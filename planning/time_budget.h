#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "planning/load_sweep.h"

namespace irsig {

// Returns the sweep with this number of samples instead of its requested accuracy.
[[nodiscard]] schema::ResolvedSweep with_samples(schema::ResolvedSweep sweep,
                                                 std::uint64_t samples);

// Returns true if the sweep requests a time budget that no pilot has converted to a number of
// samples yet.
[[nodiscard]] bool has_time_budget(const schema::ResolvedSweep& sweep);

// Computes three viewpoints in this process with few samples. Replaces the budget in the resolved
// sweep by the samples per replicate that fill it with this number of workers. Returns a line that
// states the result.
[[nodiscard]] absl::StatusOr<std::string> spend_time_budget(LoadedSweep& loaded,
                                                            std::uint32_t workers);

// Returns true if spend_time_budget could have made `stored` from `asked`: equal except for the
// samples. A resumed sweep keeps the samples with which it began, whatever a new pilot would
// measure.
[[nodiscard]] bool is_same_but_for_samples(const schema::ResolvedSweep& stored,
                                           const schema::ResolvedSweep& asked);

}  // namespace irsig
