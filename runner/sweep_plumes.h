#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/plume/plume_field.h"
#include "schema/assets.h"
#include "schema/job.pb.h"

namespace irsig {

// [ResolvedSweep.plume]: conditions of one plume share its field, whose rays are traced once.
using SweepPlumes = std::vector<std::shared_ptr<const PlumeField>>;

// Makes or reads all plumes. assets: with the plume's file. INVALID_ARGUMENT "plume...": a plume
// that cannot be made, a file that cannot be read, gas that the tables of hot gas do not have, or
// gas that reaches a sensor.
[[nodiscard]] absl::StatusOr<SweepPlumes> plumes_from_sweep(const schema::ResolvedSweep& sweep,
                                                            const Assets& assets);

// Returns the size of all fields. [bytes]
[[nodiscard]] std::size_t bytes_of(const SweepPlumes& plumes);

}  // namespace irsig
