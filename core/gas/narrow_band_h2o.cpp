#include <algorithm>
#include <cmath>

#include "core/gas/narrow_band_tables.h"

namespace irsig {

void h2o_bands(std::span<const double> wavenumber_cm1, double temperature_k,
               std::span<NarrowBand> out) {
  // Density of lines: a fit over all bands of the gas.
  const double t = std::clamp(temperature_k, 300.0, 2500.0);
  const double growth = std::exp(-2.294 + 0.3004e-2 * t - 0.366e-6 * t * t);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double strength = h2o_strengths().at(wavenumber_cm1[i], temperature_k);
    out[i] = {};
    if (strength > 0)
      out[i] = {strength, std::exp(0.7941 * std::sin(0.0036 * wavenumber_cm1[i] - 8.043)) * growth};
  }
}

}  // namespace irsig
