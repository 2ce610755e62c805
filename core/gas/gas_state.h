#pragma once

#include "absl/status/status.h"

namespace irsig {

// Hot gas of a fire, a funnel or an engine, in local thermodynamic equilibrium; what is no gas
// named here is nitrogen.
struct GasState {
  double temperature_k = 0;
  double pressure_pa = 101325;
  double h2o = 0, co2 = 0, co = 0;  // mole fractions
  double soot = 0;                  // volume fraction
};

// A straight stretch of one state.
struct GasLayer {
  GasState state;
  double length_m = 0;
  // Standard deviation of the temperature along the layer: emission is the mean of the emissions at
  // the mean plus and minus the deviation, absorption is that of the mean.
  double temperature_spread_k = 0;
};

// Range of the tables. Below 300 K the numbers of water beyond 7000 cm-1 and of CO2 at 2.7 and 2.0
// um are those of 300 K, above 2500 K water's beyond 7000 cm-1 those of 2500 K.
inline constexpr double kGasTemperatureMinK = 200, kGasTemperatureMaxK = 3000;
inline constexpr double kGasPressureMinPa = 10132.5, kGasPressureMaxPa = 202650;
inline constexpr double kGasSootMax = 1e-3;

// Checks a state. OUT_OF_RANGE or INVALID_ARGUMENT names the quantity and its value: temperature or
// pressure beyond the limits above, a mole fraction outside [0, 1] or a sum of them above 1, a soot
// volume fraction outside [0, 1e-3], a length that is negative or not finite.
[[nodiscard]] absl::Status check_gas(const GasState& state);
[[nodiscard]] absl::Status check_gas(const GasLayer& segment);

}  // namespace irsig
