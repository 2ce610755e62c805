#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "planning/load_sweep.h"

namespace irsig {

// Returns the sweep with this number of samples instead of its requested accuracy.
[[nodiscard]] schema::ResolvedSweep with_samples(schema::ResolvedSweep sweep,
                                                 std::uint64_t samples);

// Returns true if the sweep asks for a time budget that a pilot has yet to turn into a number of
// samples.
[[nodiscard]] bool has_time_budget(const schema::ResolvedSweep& sweep);

// Computes three viewpoints here, with few samples, and writes the samples per replicate that fill
// the budget on so many workers into the resolved sweep, in place of the budget.
// Returns a line that says so.
[[nodiscard]] absl::StatusOr<std::string> spend_time_budget(LoadedSweep& loaded,
                                                            std::uint32_t workers);

// Returns true if spend_time_budget once made `stored` from `asked`: equal but for the samples. A
// resumed sweep keeps the samples with which it began, whatever a new pilot would measure.
[[nodiscard]] bool is_same_but_for_samples(const schema::ResolvedSweep& stored,
                                           const schema::ResolvedSweep& asked);

}  // namespace irsig
