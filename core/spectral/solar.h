#pragma once

#include <vector>

#include "core/spectral/band.h"

namespace irsig {

// Returns the extraterrestrial solar spectral irradiance at 1 au, linear between the table's
// points; 0 outside 0.1195-1000 um. [W m^-2 um^-1]  [astm_e490]
// Accuracy: the table's, by the trapezoidal rule 1366.09 W/m2 in all and 21.1 W/m2 in 3-5 um
// (tests/physics/solar_test.cpp).
[[nodiscard]] double solar_irradiance_w_m2_um(double lambda_um);

// Relative error bounds of a grid's sums for reflected sunlight. Each panel contributes the error
// of the integral and of the first moment, for reflectances that are linear over the panel. The
// errors of panels do not cancel, since a coloured reflectance weighs each panel differently.
struct SolarQuadrature {
  std::vector<double> of_bin;  // each by itself
  double of_white = 0;         // all, where all reflect alike
};
[[nodiscard]] SolarQuadrature solar_quadrature(const Band& band, const BandGrid& grid);

// The table's total as E490 states it: a broadband irradiance b has the spectrum
// solar_irradiance_w_m2_um(lambda) * b / kSolarConstantWM2.                        [W m^-2]
inline constexpr double kSolarConstantWM2 = 1366.1;

// (1 / the Earth's distance at perihelion in AU)^2
inline constexpr double kNearestSun = 1.035;

}  // namespace irsig
