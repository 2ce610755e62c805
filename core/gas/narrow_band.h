#pragma once

#include "core/gas/curve_of_growth.h"
#include "core/gas/gas_state.h"

namespace irsig {

// Hot gases as narrow bands of lines at random: RADCAL's numbers and formulas, 50 to 9300 cm-1.
// [grosshandler1993], from [ludwig1973]; source of the numbers: data/README.md.
//
// Known errors of RADCAL, kept: CO2 is 15-40 % high within the 4.3 um band and far too low in its
// red wing below 700 K; 3.05-3.3 and 4.2-5 um away from the bands named in the code are empty; in
// 8-12 um columns at 650-800 K send 1.3 to 1.6 of what line lists give. Totals look better than
// bands (docs/methods/gas.md).
enum class HotGas { kH2o, kCo2, kCo };

// At one wavenumber (the centre of a band of 5 to 25 cm-1) and temperature [K].
[[nodiscard]] NarrowBand narrow_band(HotGas gas, double wavenumber_cm1, double temperature_k);

// Half widths at half height of the gas's lines.                                   [1/cm]
// Lorentz: collisions with H2O, CO2, CO, N2 (the rest), and with its own kind in resonance.
[[nodiscard]] double lorentz_width_cm1(HotGas gas, const GasState& state);
[[nodiscard]] double doppler_width_cm1(HotGas gas, double wavenumber_cm1, double temperature_k);

// Partial pressure x length, at 273 K.                                             [cm atm]
[[nodiscard]] double amount_cm_atm(HotGas gas, const GasLayer& segment);

}  // namespace irsig
