#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/thermal/conduction_grid.h"

namespace irsig {

// Steps of TR-BDF2 for kHeatLanes elements of one wall side by side. Private to core/thermal. So
// many lanes that GCC does not unroll a loop over them completely (up to 16), which would leave it
// scalar.
inline constexpr std::size_t kHeatLanes = 32;
// End of a step's first stage: 2 - sqrt(2) of the step.
inline constexpr double kMiddleOfStep = 0.58578643762690495;
using HeatLane = std::array<double, kHeatLanes>;

// The elimination of the inside for steps of one length. The matrix is that of the inside alone, so
// it is the same for all elements and both stages: K = capacities + implicit_s x conduction.
struct Elimination {
  Elimination(const ConductionGrid& grid, double length_s);

  double length_s, implicit_s;
  // T_i = near_i T_(i-1) + far_i T_last + s_i inside. [node]
  std::vector<double> near, far;
  std::vector<double> conduction;     // of s_(i+1) in s_i
  std::vector<double> inverse_pivot;  // of the right side in s_i
  std::vector<double> at_last;        // dT_i / dT_last where T_0 = 0
  // K with the inside eliminated: outer T_0 + across (T_0 - T_last), and the same from inside.
  double outer, across, inner;
};

struct HeatStep {
  std::size_t elimination;
  double begin, middle, end;  // shares of the interval
};

// The steps from one knot to the next.
struct HeatInterval {
  std::vector<Elimination> elimination;
  std::vector<HeatStep> step;
};

// One face of the lanes; values at the two ends of an interval, linear between.
struct HeatFace {
  struct Varying {
    HeatLane begin, change;
  };
  Varying gain_w_m2;  // absorbed
  Varying fluid_k;
  Varying forced_w_m2_k;
  HeatLane emission_w_m2_k4;  // emissivity x Stefan-Boltzmann constant
  HeatLane natural_warm, natural_cold, mixing;
};

// Water on the outer face of the lanes (evaporation.h).
struct HeatWater {
  HeatFace::Varying vapour_pa, inverse_gamma_k_pa, stomatal_w_m2_k;
  HeatLane on, bare, cover;  // on: 0 or 1
};

struct HeatLanes {
  HeatFace outer, inner;
  bool wet = false;  // whether `water` counts
  HeatWater water;
  bool inner_fixed;                       // T_last is inner.fluid_k
  std::vector<HeatLane> t;                // [node]
  std::vector<HeatLane> t_other, inside;  // [node], scratch
  // Largest so far of a step: |stored heat - what came in| over its length.
  HeatLane closure_w_m2;
};

// Computes all steps of one interval.
void advance(const ConductionGrid& grid, const HeatInterval& interval, HeatLanes& lanes);

}  // namespace irsig
