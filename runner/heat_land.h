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

}  // namespace irsig
