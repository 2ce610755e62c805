#pragma once

#include <span>

#include "core/gas/gas_state.h"

namespace irsig {

// Hot gases as narrow bands of lines at random: RADCAL's numbers and formulas, 50 to 9300 cm-1.
// [grosshandler1993], from [ludwig1973]; source of the numbers: data/README.md.
//
// Known errors of RADCAL, kept: CO2 is 15-40 % high within the 4.3 um band and far too low in its
// red wing below 700 K; 3.05-3.3 and 4.2-5 um away from the bands named in the code are empty; in
// 8-12 um columns at 650-800 K send 1.3 to 1.6 of what line lists give. Totals look better than
// bands (docs/explanation/methods/gas.md).
enum class HotGas { kH2o, kCo2, kCo };

// Mean absorption of lines that lie at random within a narrow band.
struct NarrowBand {
  double strength_per_cm_atm = 0;  // S/d, of the gas at 273 K and 1 atm; 0: no lines here
  double lines_per_cm1 = 1;        // 1/d, of the lines that count
};

// Returns false if the gas has no lines at random there, at any temperature (hot_lines.h may have
// others).
[[nodiscard]] bool narrow_band_exists(HotGas gas, double wavenumber_cm1);

// Computes the parameters at some wavenumbers (centres of bands of 5 to 25 cm-1) and one
// temperature [K].
void narrow_bands(HotGas gas, std::span<const double> wavenumber_cm1, double temperature_k,
                  std::span<NarrowBand> out);

// Return half widths at half height of the gas's lines, Lorentz's by collisions with H2O, CO2, CO
// and N2 (the rest), and with its own kind in resonance. [1/cm]
[[nodiscard]] double lorentz_width_cm1(HotGas gas, const GasState& state);
[[nodiscard]] double doppler_width_cm1(HotGas gas, double wavenumber_cm1, double temperature_k);

// Returns the pressure of pure nitrogen in which the gas's lines are as wide as in the state: more
// than the state's own for water, whose own kind widens its lines five times as much; for other
// gases the state's own.                                                            [Pa]
[[nodiscard]] double line_pressure_pa(HotGas gas, const GasState& state);

// Returns partial pressure x length, at 273 K. [cm atm]
[[nodiscard]] double amount_cm_atm(HotGas gas, const GasLayer& segment);

}  // namespace irsig
