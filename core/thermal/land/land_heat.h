#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/land/land_kinds.h"
#include "core/thermal/scene/scene_heat.h"

namespace irsig {

// Temperatures of land in the weather: of each of its kinds.

// A material of land whose temperature is computed.
struct LandHeatMaterial {
  WallBuildUp wall;  // not open inside
  double solar_absorptance = 0, emissivity = 1;
};

struct LandHeatRequest {
  // [material of LandKinds] Nothing: its temperature is stated, and its kinds get stated_k.
  std::vector<std::optional<LandHeatMaterial>> material;
  std::vector<double> stated_k;
  // Weather at knots, as SceneHeatRequest has it.
  std::vector<double> knot_s;
  std::vector<HeatWeather> weather;  // [knot]
  std::size_t day_knots = 0;
  std::vector<std::size_t> output_knot;  // even, increasing
  double heading_deg = 0;                // of the frame of HeatWeather
  double convection_factor = 1;
  double tolerance_k = 0.01;
  // True in a moved request if the move is of the model (solve_land_heat_changes).
  bool of_model = false;
};

struct LandHeatResult {
  // [output][kind] error_k: of conduction and of the knots, and the root mean square of what the
  // held-out places of the material differ by from the kinds that stand for them. 0: stated.
  std::vector<std::vector<float>> kelvin, error_k;
  // [output][material] That root mean square alone. Not a number: no place was held out.
  std::vector<std::vector<float>> interpolation_k;
};

// Computes temperatures of land by kinds. A kind absorbs sunlight from the sky above its horizon
// and from level land of its own material around it, and exchanges heat with the sky and with land
// as warm as a level place of the material. INVALID_ARGUMENT names the fault of a build-up.
[[nodiscard]] absl::StatusOr<LandHeatResult> solve_land_heat(const LandKinds& kinds,
                                                             const LandHeatRequest& request);

// Changes of temperatures under another request.  [output][kind] [K]
struct LandTemperatureChange {
  std::vector<std::vector<float>> difference_k;  // 0: stated
  std::vector<std::vector<float>> change_k;      // by the model: at least that of the day around
};
struct LandHeatChanges {
  std::vector<std::vector<float>> kelvin;  // [output][kind] of the request that is moved
  std::vector<LandTemperatureChange> moved;
};

// Computes the changes under moved requests (of the same knots and outputs: another weather, other
// walls) from every second knot, for the kinds alone: both sides of each difference have the errors
// of these knots. A change by the model is at least as large as its root mean square over the 24 h
// around, as that of a target's facet is (solve_scene_heat_changes).
[[nodiscard]] absl::StatusOr<LandHeatChanges> solve_land_heat_changes(
    const LandKinds& kinds, const LandHeatRequest& request, std::span<const LandHeatRequest> moved);

}  // namespace irsig
