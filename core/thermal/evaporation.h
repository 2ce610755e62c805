#pragma once

#include <optional>

#include "absl/status/status.h"

namespace irsig {

// Latent heat at the outer face of a wall: water that evaporates from it, or condenses on it as
// dew. With the convection coefficient h of the face (convection.h) it loses
//
//   c (e_s(T) - e) / gamma                                                           [W m^-2]
//   c = bare h_v + cover h_v g / (h_v + g)   where water evaporates, e_s(T) > e
//   c = h_v                                  where it condenses
//
// with
//
//   h_v    h Le^(-2/3), Le = 0.85: Lewis relation of heat and vapour [incropera2007, sect. 6.7]
//   e_s    saturation pressure over water at the face's temperature [sonntag1990]
//   e      vapour pressure of the air
//   gamma  psychrometric constant c_p p / (0.622 L) [allen1998, eq. 8]
//   bare   share of the face that plants do not cover, times its moisture
//   cover  share that plants cover, 1 - exp(-leaf area index / 2) [monteith2013]
//   g      conductance of the plants' stomata (stomatal_w_m2_k)
//
// This is the balance of Penman and Monteith [allen1998, eq. 3], solved for the temperature of the
// face instead of being linearised in it.
//
// Limits: the moisture stays as it is stated (no rain, no drying, no dew that is stored); ice
// counts as water, which leaves out the heat of fusion, 13 %.
struct Evaporation {
  bool on = false;             // false: neither evaporation nor dew
  double bare = 0, cover = 0;  // [0, 1], together at most 1
};

// Plants on a face.
struct Canopy {
  double leaf_area_index;          // one-sided area of leaves over that of the face, (0, 20]
  double stomatal_resistance_s_m;  // of a leaf in full light, [10, 1e4]
};

// Water that a face offers to the air.
struct SurfaceWater {
  double moisture = 0;  // of what plants do not cover, 0 dry .. 1 as wet as water
  std::optional<Canopy> canopy = {};
};
// Checks the water of a surface. INVALID_ARGUMENT names the number that is out of its range.
[[nodiscard]] absl::Status check_water(const SurfaceWater& water);
[[nodiscard]] Evaporation evaporation_of(const SurfaceWater& water);

// Humid air at one instant.
struct HumidAir {
  double dew_point_k, pressure_pa;
};

// Returns 1 / gamma, with the latent heat L of water at the air's temperature.  [K/Pa]
[[nodiscard]] double inverse_gamma_k_pa(double air_k, double pressure_pa);

// Returns the conductance of the stomata of a canopy, as a coefficient of heat transfer.
//
//   g = rho c_p f(S) (leaf area index / 2) / stomatal_resistance      [allen1998, eq. 5]
//   f(S) = S (1000 + 104.4) / (1000 (S + 104.4)), at most 1           [jarvis1976; stewart1988]
//
// Half of the leaves' area transpires; stomata are closed in the dark.
//   sunlight_w_m2  on the face, >= 0
[[nodiscard]] double stomatal_w_m2_k(const Canopy& canopy, double sunlight_w_m2, double air_k,
                                     double pressure_pa);

}  // namespace irsig
