#pragma once

#include <string>
#include <vector>

#include "schema/job.pb.h"

namespace irsig {

// An input of a sweep that is not known exactly: a key of [uncertainty], and its one sigma in the
// key's unit ("relative": as a fraction of the value).
struct UncertainInput {
  std::string name;
  double sigma = 0;

  bool operator==(const UncertainInput&) const = default;
};

// Returns the uncertain inputs that a sweep states, in the order of the grammar.
[[nodiscard]] std::vector<UncertainInput> uncertain_inputs(const schema::Uncertainty& uncertainty);

// A resolved sweep with one input moved by `move` sigmas: every value of the input in conditions,
// heat runs, materials and build-ups, and nothing else. All of them share one weather:
//
//   air_temperature_k    air at the surface and in the course, at the same dew point (or at the
//                        air's temperature, if that is lower); long-wave radiation of the sky that
//                        a weather file states is scaled with the fourth power of the air's
//                        temperature
//   convection_relative  of faces in air, natural and forced
//   sky_emissivity_relative   long-wave radiation of the sky on walls, if the course states none
//   dew_point_k          at most the temperature of the air
//   wind_speed_*         of the course; and of conditions with a rough sea or the Navy's aerosol
//   emissivity           of the materials of parts: in the bands, and thermal_emissivity if stated
//   part_temperature_k   temperatures that are stated or read from files
//   land_*               materials and layers of land that no part has; land_temperature_k: stated
//                        temperatures. Emissivities that follow from optical constants stay
//
// Values stay within their possible range (emissivity up to 1, wind from 0). `share` is the mean
// fraction of the move that the values could make; 0: none.
struct MovedSweep {
  schema::ResolvedSweep sweep;
  int values = 0;    // that belong to the input: 0: the sweep does not have it
  double share = 0;  // [0, 1]
  // Materials of parts whose emissivity follows from something else, so that it cannot be moved.
  std::vector<std::string> without;
};
[[nodiscard]] MovedSweep moved_sweep(const schema::ResolvedSweep& sweep,
                                     const UncertainInput& input, double move);

// Returns the moves by which an input is evaluated: 1 and -1 if `sides` is "both"; else the one
// that its values can make better, and 1 if both are equal.
[[nodiscard]] std::vector<double> moves_of(const schema::ResolvedSweep& sweep,
                                           const UncertainInput& input);

// Returns true if the temperatures of the target's parts, or those of land, in a heat run depend on
// a move. run: an index in both sweeps.
[[nodiscard]] bool moves_parts(const schema::ResolvedSweep& sweep,
                               const schema::ResolvedSweep& moved, int run);
[[nodiscard]] bool moves_land(const schema::ResolvedSweep& sweep,
                              const schema::ResolvedSweep& moved, int run);

// Returns the first index in ResolvedSweep.heat of the changes to the temperatures of a run. -1:
// there is none.
[[nodiscard]] int changes_of_run(const schema::ResolvedSweep& sweep, int run);

}  // namespace irsig
