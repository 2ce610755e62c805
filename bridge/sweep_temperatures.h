#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/scene/mesh.h"
#include "core/scene/target.h"
#include "core/sources/emission.h"
#include "schema/assets.h"

namespace irsig {

// The temperatures of a sweep's facets, where they have their own.
struct SweepTemperatures {
  std::shared_ptr<const Emitters> emitters;  // null: each part has one temperature
  // [condition]; then also, of each part whose facets have their own: the hottest one, its error
  // included, and their mean. Else 0.                                                      [K]
  std::vector<std::shared_ptr<const EmitterTemperatures>> condition;
  std::vector<std::vector<double>> part_k, part_mean_k;
};

// [condition][facet] of a sweep, NaN where its part's temperature is stated; empty: all are.
// part_of_facet: of `mesh`, the sweep's. INVALID_ARGUMENT: what is wrong with a file; a facet of a
// part without temperature, or with an error that leaves nothing of it; an instant beyond the
// file's.
[[nodiscard]] absl::StatusOr<std::vector<FacetTemperatures>> facet_temperatures(
    const schema::ResolvedSweep& sweep, const Assets& assets, const Mesh& mesh,
    const std::vector<std::uint32_t>& part_of_facet);

// Whether a part is 30 K or more above the coldest part in any condition, facets by their mean:
// what Part.hot is by default (jobs/resolve_sweep.cpp, where all temperatures are stated). Not by
// the hottest facet: of a hull in the sun every part has warm ones, and all parts would be hot.
[[nodiscard]] bool is_hot(const schema::ResolvedSweep& sweep, const SweepTemperatures& temperatures,
                          std::size_t part);

[[nodiscard]] absl::StatusOr<SweepTemperatures> temperatures_from_sweep(
    const schema::ResolvedSweep& sweep, const Assets& assets, const Mesh& mesh,
    const std::vector<PartSpec>& parts);

}  // namespace irsig
