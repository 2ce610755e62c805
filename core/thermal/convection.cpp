#include "core/thermal/convection.h"

#include <cmath>

namespace irsig {

double mowitt_forced_w_m2_k(double wind_m_s, WindSide side) {
  return side == WindSide::kWindward ? 3.26 * std::pow(wind_m_s, 0.89)
                                     : 3.55 * std::pow(wind_m_s, 0.617);
}

Convection tarp_natural(double cos_tilt) {
  const double c = std::abs(cos_tilt);
  const double unstable = 9.482 / (7.238 - c), stable = 1.810 / (1.382 + c);
  return cos_tilt >= 0 ? Convection{unstable, stable, 1} : Convection{stable, unstable, 1};
}

double tarp_forced_w_m2_k(double wind_m_s, double perimeter_m, double area_m2, double roughness,
                          WindSide side) {
  const double windward = 2.537 * roughness * std::sqrt(perimeter_m * wind_m_s / area_m2);
  return side == WindSide::kWindward ? windward : 0.5 * windward;
}

Fluid sea_water(double temperature_k) {
  constexpr double kSalt = 0.035, kHeatCapacityJM3K = 4.10e6, kDensityKgM3 = 1026;
  const double t = temperature_k - 273.15;
  const double fresh = 4.2844e-5 + 1 / (0.157 * (t + 64.993) * (t + 64.993) - 91.296);
  const double a = 1.541 + (1.998e-2 - 9.52e-5 * t) * t;
  const double b = 7.974 + (-7.561e-2 + 4.724e-4 * t) * t;
  Fluid water{};
  water.conductivity_w_m_k = 0.570 + 0.0014 * t;
  water.kinematic_viscosity_m2_s = fresh * (1 + (a + b * kSalt) * kSalt) / kDensityKgM3;
  water.prandtl = water.kinematic_viscosity_m2_s * kHeatCapacityJM3K / water.conductivity_w_m_k;
  return water;
}

double plate_in_flow_w_m2_k(const Fluid& fluid, double speed_m_s, double length_m) {
  const double reynolds = speed_m_s * length_m / fluid.kinematic_viscosity_m2_s;
  const double nusselt =
      (reynolds < 5e5 ? 0.664 * std::sqrt(reynolds) : 0.037 * std::pow(reynolds, 0.8) - 871) *
      std::cbrt(fluid.prandtl);
  return nusselt * fluid.conductivity_w_m_k / length_m;
}

}  // namespace irsig
