#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/trace/target.h"
#include "core/thermal/day_schedule.h"
#include "core/thermal/evaporation.h"
#include "core/thermal/heat_request.h"

namespace irsig {

// Thermal properties of a part. Reflection is diffuse.
struct HeatPart {
  double solar_absorptance;               // [0, 1]
  double emissivity;                      // hemispherical, total, long-wave: [0, 1]
  std::optional<std::uint32_t> build_up;  // none: its temperature is stated
  double stated_k = 0;
};

struct WallBuildUp {
  std::string name;  // for messages
  std::vector<Layer> layers;
  InnerSide inner_side = InnerSide::kAdiabatic;  // kOpen: for parts seen from both sides
  double inner_k = 0;                            // kAir, kFixedTemperature
  double inner_h_w_m2_k = 0;                     // kAir
  double inner_flux_w_m2 = 0;                    // kHeatFlux
  // [knot] Instead of inner_k, of kHeatFlux instead of inner_flux_w_m2, where that changes: linear
  // between knots. A jump at an odd knot, which the second computation lacks, is one of the
  // differences of the two. Empty: it does not change.
  std::vector<ScheduleAtKnot> inner_at = {};
  // Water on the outer face, not with kOpen; a face under the surface has none. Empty: no latent
  // heat.
  std::optional<SurfaceWater> water = {};

  [[nodiscard]] bool jumps_at(std::size_t knot) const {
    return !inner_at.empty() && inner_at[knot].before != inner_at[knot].after;
  }
};

// The surface below the horizon. Facets below its height take the temperature of the water that
// flows along, or that of the ground.
struct GroundBoundary {
  bool water = false;
  double surface_z_m = 0;  // of the body frame, down; infinite: no surface
  double temperature_k = 0;
  double emissivity = 1, solar_albedo = 0;  // [0, 1]
  double flow_m_s = 0;                      // of water along the hull
  // [knot] In place of temperature_k of a ground whose temperature changes; empty: it does not.
  std::vector<double> temperature_at_k = {};

  [[nodiscard]] double kelvin_at(std::size_t knot) const {
    return temperature_at_k.empty() ? temperature_k : temperature_at_k[knot];
  }
};

// Sky and air at one instant.
struct HeatRadiation {
  double direct_normal_w_m2, diffuse_horizontal_w_m2;
  double sky_w_m2;  // long-wave, horizontal
};
struct HeatWeather {
  double air_k;
  double wind_m_s;                     // relative to the target
  Vec<Body> wind_from;                 // unit vector, horizontal: where it comes from
  Vec<Body> sun;                       // unit vector towards the sun
  double sun_radius_rad;               // its angular radius
  HeatRadiation before, after;         // the instant: of records that are means they jump
  std::optional<HumidAir> humid = {};  // required where a wall has water
};

struct SceneHeatRequest {
  std::vector<HeatPart> part;  // of the target
  std::vector<WallBuildUp> build_up;
  GroundBoundary beneath;
  // Weather at knots, linear between. Every second one, from the first, is a knot of the
  // computation that shows the errors; so the count is odd.
  std::vector<double> knot_s;
  std::vector<HeatWeather> weather;  // [knot]
  std::size_t day_knots;  // the first so many intervals are a day that has repeated for ever
  std::vector<std::size_t> output_knot;  // even, increasing
  std::uint32_t rays = 256;              // of each face to its surroundings
  std::uint32_t sun_points = 16;         // of each face, for every place of the sun
  std::uint64_t seed = 1;
  double convection_factor = 1;        // of all faces in air, [0, 10]
  double tolerance_k = 0.01;           // of conduction
  double exchange_tolerance_k = 0.02;  // half of it may be left by the last pass
  // Effects that may be left out. Without `exchange` the other faces in sight of a face are black
  // and as warm as the air; without `diffuse_sun` the sky's sunlight warms nothing. error_k then
  // includes the largest change.
  bool exchange = true, diffuse_sun = true;
  // True in a moved request if the move is of the model (solve_scene_heat_changes).
  bool of_model = false;
  bool effect_bounds = false;  // whether SceneHeatResult has theirs; where one is off it always has
};

}  // namespace irsig
