#pragma once

#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// Hot gas that leaves an opening upwards into a uniform wind.
struct PlumeExit {
  double diameter_m = 0, velocity_m_s = 0, temperature_k = 0;
};
struct PlumeAir {
  double wind_m_s = 0;  // relative to the opening
  double temperature_k = 288.15, pressure_pa = 101325;
};

// A cross-section of the plume, perpendicular to its axis: uniform over its radius.
struct PlumeStation {
  double s_m = 0;                // along the axis
  double x_m = 0, height_m = 0;  // downwind and above the opening
  double angle_rad = 0;          // of the axis above the horizontal
  double radius_m = 0;
  double velocity_m_s = 0;  // along the axis
  double share = 1;         // of exhaust gas in the mass (and in the moles), the rest is air
};

// Coefficients of entrainment: of a plume that rises by itself, and of one carried by wind.
// beta = 0.6 makes the bent plume rise as Briggs found, 1.6 F^(1/3) x^(2/3) / U. [hoult1972,
// briggs1984]
inline constexpr double kEntrainmentAlong = 0.11, kEntrainmentAcross = 0.6;

// Computes the axis of a buoyant plume in a wind, from the opening to where it is length_m long, by
// the integral model of Hoult, Fay and Forney [hoult1969]: steady fluxes (divided by pi) of mass m
// = rho u R^2, of momentum and of heat,
//
//   dm/ds = 2 R rho_a (alpha |u - U cos theta| + beta U |sin theta|)
//   d(m u cos theta)/ds = U dm/ds,  d(m u sin theta)/ds = g (rho_a - rho) R^2
//
// with share = m_0 / m and T = T_a + share (T_0 - T_a): exhaust and air of one molar mass and one
// heat capacity, adiabatic mixing, no stratification, no downwash behind the funnel. Not
// Boussinesq.
//
// Steps are a fraction of the radius (Runge and Kutta, fourth order): halving them changes nothing
// by more than 1e-7. INVALID_ARGUMENT: dimensions that are not positive, gas that is not hotter
// than the air, more than 3000 K, slower than 0.1 m/s or faster than 500 m/s (the model is
// incompressible).
[[nodiscard]] absl::StatusOr<std::vector<PlumeStation>> bent_plume(const PlumeExit& exit,
                                                                   const PlumeAir& air,
                                                                   double length_m,
                                                                   double step_fraction = 0.02);

// Returns Briggs' flux of buoyancy F = g w R^2 (T_0 - T_a) / T_0. [m4/s3]
[[nodiscard]] double buoyancy_flux_m4_s3(const PlumeExit& exit, const PlumeAir& air);

// Returns the density of air at the pressure of `air` (and of exhaust, see above). [kg/m3]
[[nodiscard]] double density_kg_m3(const PlumeAir& air, double temperature_k);

}  // namespace irsig
