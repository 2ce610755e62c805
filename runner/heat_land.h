#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/land/land_scene.h"
#include "core/scene/mesh.h"
#include "schema/job.pb.h"
#include "schema/result.pb.h"

namespace irsig {

// Returns an upper bound of the number of kinds that the land of a sweep has.
[[nodiscard]] std::size_t most_land_kinds(const schema::Sweep& sweep);

// Temperatures of land at every second knot of a heat run's weather.
struct LandCourse {
  LandKinds kinds;
  std::vector<std::vector<float>> kelvin;  // [second knot][kind]
};

// Computes the temperatures of land in a heat run that computes land, at each requested time, and
// sets those at every second knot. Appends warnings that are not there yet. INVALID_ARGUMENT, by
// the key's path: a material without solar_absorptance, or a build-up that leads to temperatures
// outside of all weather.
[[nodiscard]] absl::StatusOr<schema::LandHeat> compute_land_heat(const schema::Sweep& sweep,
                                                                 const schema::HeatRun& heat,
                                                                 const LandScene& land,
                                                                 std::vector<std::string>& warning,
                                                                 LandCourse& course);

// Changes of the temperatures of land by the inputs of a run.
struct LandChangesOfRun {
  std::vector<std::string> change_k;  // [input] as HeatField::land_change_k
  LandCourse course;                  // of the run without its inputs
  // [input][second knot][kind] Differences to the course; an input that moves no land has none.
  std::vector<std::vector<std::vector<float>>> difference_k;
};

// Computes the changes of a run that changes land. resolved: with the run; INVALID_ARGUMENT: as
// above, by the input's path.
[[nodiscard]] absl::StatusOr<LandChangesOfRun> compute_land_changes(
    const schema::ResolvedSweep& resolved, const schema::HeatRun& heat, const LandScene& land);

// Returns the temperature of the land that a target sees below its horizon at every knot: that of a
// surface which sends as much heat as it on average. Empty: the map has no land around it.
//   difference_k  to the course's; empty: none
//   surface_z_m   body z of the land below the target
[[nodiscard]] std::vector<double> ground_around_k(
    const LandScene& land, const LandCourse& course,
    const std::vector<std::vector<float>>& difference_k, const Mesh& mesh, double surface_z_m,
    const std::vector<double>& knot_s);

}  // namespace irsig
