#pragma once

#include "absl/status/statusor.h"

namespace irsig {

// Exhaust of an engine: fuel of one carbon atom and hydrogen_per_carbon hydrogen atoms (1.85:
// marine diesel), burnt with more air than it needs.
struct ExhaustSpec {
  double hydrogen_per_carbon = 1.85;
  double excess_air = 1.2;   // 0: just enough; 1.2: 2.2 times as much, a diesel engine at load
  double carbon_as_co = 0;   // share of the fuel's carbon
  double soot_g_per_kg = 0;  // of fuel
};

// Mole fractions in the wet exhaust; soot: volume fraction at the temperature and pressure of the
// exit. The air is dry, 20.95 % oxygen, without CO2: what the plume has beside the air around it.
struct ExhaustGas {
  double co2 = 0, h2o = 0, co = 0, soot = 0;
};

// Computes the exhaust by balance of atoms. INVALID_ARGUMENT: hydrogen outside 0 to 4, excess air
// outside 0 to 20, CO outside 0 to 1, soot outside 0 to 100 g/kg, or more carbon in CO and soot
// than in the fuel.
[[nodiscard]] absl::StatusOr<ExhaustGas> exhaust_gas(const ExhaustSpec& spec, double temperature_k,
                                                     double pressure_pa);

}  // namespace irsig
