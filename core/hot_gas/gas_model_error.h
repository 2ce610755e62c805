#pragma once

#include "core/hot_gas/column_tests.h"

namespace irsig {

// Returns one sigma of ln(-ln T) of the bands of hot gas, from the disagreement of their sources:
// the optical depth at `wavenumber_cm1` of CO2, H2O and CO together, at `temperature_k`. For soot
// there is no second source. Sources and figures: docs/explanation/methods/gas.md.
[[nodiscard]] double hot_depth_error(double wavenumber_cm1, double temperature_k);

// Returns one sigma of a column's absorptance in a band. The gases' part of the optical depth
// behind `absorptance` may be wrong by hot_depth_error(), at the temperature that emits.
[[nodiscard]] double absorptance_error(double absorptance, double wavenumber_cm1,
                                       const GasColumn& column, double temperature_k);

}  // namespace irsig
