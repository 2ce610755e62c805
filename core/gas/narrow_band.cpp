#include "core/gas/narrow_band.h"

#include <cmath>

#include "core/gas/narrow_band_tables.h"

namespace irsig {
namespace {

double share(HotGas gas, const GasState& s) {
  switch (gas) {
    case HotGas::kH2o:
      return s.h2o;
    case HotGas::kCo2:
      return s.co2;
    case HotGas::kCo:
      return s.co;
  }
  return 0;
}

// Half width at 273 K and 1 atm of the partner [1/(cm atm)].            [ludwig1973, table 5-18]
struct Widths {
  double co2, h2o, co, n2, resonant, molar_mass_g;
};
constexpr Widths widths(HotGas gas) {
  switch (gas) {
    case HotGas::kH2o:
      return {0.12, 0.09, 0.10, 0.09, 0.44, 18};
    case HotGas::kCo2:
      return {0.09, 0.07, 0.06, 0.07, 0.01, 44};
    case HotGas::kCo:
      return {0.07, 0.06, 0.06, 0.06, 0, 28};
  }
  return {};
}

}  // namespace

bool narrow_band_exists(HotGas gas, double nu) {
  switch (gas) {
    case HotGas::kH2o:
      return true;
    case HotGas::kCo2:
      return (nu > 500 && nu <= 1100) || (nu > 3050 && nu <= 3800) || (nu > 4550 && nu <= 5725);
    case HotGas::kCo:
      return nu >= 1600 && nu <= 2400;
  }
  return false;
}

void narrow_bands(HotGas gas, std::span<const double> wavenumber_cm1, double temperature_k,
                  std::span<NarrowBand> out) {
  switch (gas) {
    case HotGas::kH2o:
      return h2o_bands(wavenumber_cm1, temperature_k, out);
    case HotGas::kCo2:
      return co2_bands(wavenumber_cm1, temperature_k, out);
    case HotGas::kCo:
      for (std::size_t i = 0; i < out.size(); ++i)
        out[i] = co_band(wavenumber_cm1[i], temperature_k);
  }
}

double lorentz_width_cm1(HotGas gas, const GasState& s) {
  const Widths w = widths(gas);
  const double cold = 273 / s.temperature_k;
  const double n2 = std::fmax(0, 1 - s.h2o - s.co2 - s.co);
  return s.pressure_pa / 101325 *
         ((w.co2 * s.co2 + w.h2o * s.h2o + w.co * s.co + w.n2 * n2) * std::sqrt(cold) +
          w.resonant * share(gas, s) * cold);
}

double doppler_width_cm1(HotGas gas, double wavenumber_cm1, double temperature_k) {
  return 5.94e-6 * wavenumber_cm1 * std::sqrt(temperature_k / (273 * widths(gas).molar_mass_g));
}

double line_pressure_pa(HotGas gas, const GasState& s) {
  if (gas != HotGas::kH2o) return s.pressure_pa;
  GasState nitrogen;
  nitrogen.temperature_k = s.temperature_k;
  nitrogen.pressure_pa = s.pressure_pa;
  return s.pressure_pa * lorentz_width_cm1(gas, s) / lorentz_width_cm1(gas, nitrogen);
}

double amount_cm_atm(HotGas gas, const GasLayer& segment) {
  const GasState& s = segment.state;
  return share(gas, s) * s.pressure_pa / 101325 * 100 * segment.length_m * 273 / s.temperature_k;
}

}  // namespace irsig
