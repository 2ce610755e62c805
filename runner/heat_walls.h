#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/thermal/scene/scene_heat.h"
#include "schema/sweep.pb.h"

namespace irsig {

// Materials and layers of the walls and of the ground of a heat run.

struct HeatSurface {
  double solar_absorptance, emissivity;  // [0, 1]
};
// Returns the surface of a material; appends a warning if the material's spectrum covers too little
// of its emission. path: "material[2]", for errors and warnings.
[[nodiscard]] absl::StatusOr<HeatSurface> heat_surface(const schema::Material& material,
                                                       const std::string& path,
                                                       std::vector<std::string>& warning);

// Returns the build-ups of a sweep, in their order, with their schedules at the knots.
[[nodiscard]] absl::StatusOr<std::vector<WallBuildUp>> walls_at_knots(
    const schema::Sweep& sweep, const std::vector<double>& knot_s);

}  // namespace irsig
