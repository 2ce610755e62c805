#include <cmath>

#include "core/gas/narrow_band_tables.h"

namespace irsig {

// The fundamental and its hot bands, each a P and an R branch of an anharmonic rotating oscillator
// whose lines are smeared out: at a wavenumber the two rotational quantum numbers that belong to
// it.
NarrowBand co_band(double wavenumber_cm1, double temperature_k) {
  if (wavenumber_cm1 < 1600 || wavenumber_cm1 > 2400) return {};
  constexpr double kB = 1.93139, kBandStrength = 260, kA = 0.017485;  // cm-1; cm-2 atm-1 at 300 K
  constexpr double kOmega = 2170.21, kWx = 13.461, kWy = 0.0308;      // cm-1
  constexpr double kFundamental = kOmega - 2 * kWx + 3.25 * kWy;
  const double c2_t = kRadcalC2CmK / temperature_k;
  const double aa = kBandStrength * kB * kRadcalC2CmK /
                    (kA * std::pow(1 - std::exp(-kFundamental * kRadcalC2CmK / kRadcalT0K), 2));
  const double bb =
      (1 - std::exp(-wavenumber_cm1 * c2_t)) * std::pow(1 - std::exp(-kFundamental * c2_t), 2);
  const double cc = aa * bb * wavenumber_cm1 * kRadcalT0K / (temperature_k * temperature_k);
  double weak = 0, strong = 0;
  for (int v = 0; v < 20; ++v) {
    const double gamma = kB - kA * (v + 1);
    const double centre = kOmega - 2 * (v + 1) * kWx + (3.0 * (v + 1) * (v + 1) + 0.25) * kWy;
    const double delta = kA * (wavenumber_cm1 - centre);
    if (gamma * gamma <= delta) break;
    const double d = 2 * std::sqrt(gamma * gamma - delta);
    const double rate = kRadcalC2CmK * gamma / (kA * kA * temperature_k);
    const double share =
        cc * (v + 1) * std::exp(-v * kOmega * c2_t) / (centre * (1 - std::exp(-centre * c2_t)));
    const auto branch = [&](double f) {
      return share * std::abs(f) *
             std::exp(rate * (delta * (1 + 0.5 * kA / gamma) - 2 * gamma * f));
    };
    const double minus = branch(gamma - 0.5 * d), plus = branch(gamma + 0.5 * d);
    weak += (minus + plus) / d;
    if (!(minus + plus >= 1e-4 * weak * d) || !(weak > 0)) break;
    strong += (std::sqrt(minus) + std::sqrt(plus)) / d;
  }
  if (!(weak > 0) || !(strong > 0)) return {};
  return {weak * temperature_k / 273, strong * strong / weak};
}

}  // namespace irsig
