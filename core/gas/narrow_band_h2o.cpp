#include <algorithm>
#include <cmath>

#include "core/gas/narrow_band_tables.h"

namespace irsig {

NarrowBand h2o_band(double wavenumber_cm1, double temperature_k) {
  const double strength = h2o_strengths().at(wavenumber_cm1, temperature_k);
  if (!(strength > 0)) return {};
  // Density of lines: a fit over all bands of the gas.
  const double t = std::clamp(temperature_k, 300.0, 2500.0);
  const double growth = -2.294 + 0.3004e-2 * t - 0.366e-6 * t * t;
  return {strength, std::exp(0.7941 * std::sin(0.0036 * wavenumber_cm1 - 8.043) + growth)};
}

}  // namespace irsig
