#pragma once

#include <string>
#include <vector>

#include "schema/job.pb.h"

namespace irsig {

// An input of a sweep that is not known exactly: a key of [uncertainty], and its one sigma in the
// key's unit ("relative": as a share of the value).
struct UncertainInput {
  std::string name;
  double sigma = 0;

  bool operator==(const UncertainInput&) const = default;
};

// Returns the uncertain inputs that a sweep states, in the order of the grammar.
[[nodiscard]] std::vector<UncertainInput> uncertain_inputs(const schema::Uncertainty& uncertainty);

// A resolved sweep as it would be if an input were `move` sigmas higher: every value of it in
// conditions, heat runs, materials and build-ups, and nothing else. One weather drives all:
//
//   air_temperature_k    air at the surface and in the course, at the same dew point (or at the
//   air's,
//                        if that is lower); long-wave radiation of the sky that a weather file
//                        states goes with the fourth power of the air's temperature
//   convection_relative  of faces in air, natural and forced
//   sky_emissivity_relative   long-wave radiation of the sky of walls, where the course states none
//   dew_point_k          at most that of the air
//   wind_speed_*         of the course; and of conditions where a rough sea or the Navy's aerosol
//   asks emissivity           of the materials of parts: in the bands, and thermal_emissivity if
//   stated part_temperature_k   those that are stated or read from files
//   land_*               materials and layers of land that no part has; land_temperature_k: those
//                        that are stated. Emissivities that follow from optical constants stay.
//
// Values stay within the range that they can have (emissivity up to 1, wind from 0): `share` is how
// much of the move they could make, on average; 0: none.
struct MovedSweep {
  schema::ResolvedSweep sweep;
  int values = 0;    // that belong to the input: 0: the sweep does not have it
  double share = 0;  // [0, 1]
  // Materials of parts whose emissivity follows from something else, so that it cannot be moved.
  std::vector<std::string> without;
};
[[nodiscard]] MovedSweep moved_sweep(const schema::ResolvedSweep& sweep,
                                     const UncertainInput& input, double move);

// The moves by which an input is judged: 1 and -1 if `sides` is "both", else the one which its
// values can make better, 1 if both are the same.
[[nodiscard]] std::vector<double> moves_of(const schema::ResolvedSweep& sweep,
                                           const UncertainInput& input);

// Returns true if the temperatures of the target's parts, or those of land, in a heat run depend on
// a move. run: an index in both sweeps.
[[nodiscard]] bool moves_parts(const schema::ResolvedSweep& sweep,
                               const schema::ResolvedSweep& moved, int run);
[[nodiscard]] bool moves_land(const schema::ResolvedSweep& sweep,
                              const schema::ResolvedSweep& moved, int run);

// The first index in ResolvedSweep.heat of changes to the temperatures of a run, -1: none.
[[nodiscard]] int changes_of_run(const schema::ResolvedSweep& sweep, int run);

}  // namespace irsig
