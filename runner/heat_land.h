#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/land/land_scene.h"
#include "schema/job.pb.h"
#include "schema/result.pb.h"

namespace irsig {

// Returns an upper bound of the number of kinds that the land of a sweep has.
[[nodiscard]] std::size_t most_land_kinds(const schema::Sweep& sweep);

// Computes the temperatures of land in a heat run that computes land, at each requested time.
// Appends warnings that are not there yet. INVALID_ARGUMENT, by the key's path: a material without
// solar_absorptance, or a build-up that leads to temperatures outside of all weather.
[[nodiscard]] absl::StatusOr<schema::LandHeat> compute_land_heat(const schema::Sweep& sweep,
                                                                 const schema::HeatRun& heat,
                                                                 const LandScene& land,
                                                                 std::vector<std::string>& warning);

// Computes by how much each input of a run that changes land changes the temperatures of its kinds.
// [input] As HeatField::land_change_k. resolved: with the run; INVALID_ARGUMENT: as above, by the
// input's path.
[[nodiscard]] absl::StatusOr<std::vector<std::string>> compute_land_changes(
    const schema::ResolvedSweep& resolved, const schema::HeatRun& heat, const LandScene& land);

}  // namespace irsig
