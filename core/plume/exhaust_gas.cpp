#include "core/plume/exhaust_gas.h"

#include "core/base/constants.h"
#include "fmt/format.h"

namespace irsig {

absl::StatusOr<ExhaustGas> exhaust_gas(const ExhaustSpec& spec, double temperature_k,
                                       double pressure_pa) {
  const auto refuse = [](const char* what, double is, const char* expected) {
    return absl::InvalidArgumentError(fmt::format("{} {:g}, expected {}", what, is, expected));
  };
  if (!(spec.hydrogen_per_carbon >= 0 && spec.hydrogen_per_carbon <= 4))
    return refuse("hydrogen per carbon", spec.hydrogen_per_carbon, "0 to 4");
  if (!(spec.excess_air >= 0 && spec.excess_air <= 20))
    return refuse("excess air", spec.excess_air, "0 (just enough) to 20");
  if (!(spec.carbon_as_co >= 0 && spec.carbon_as_co <= 1))
    return refuse("share of carbon as CO", spec.carbon_as_co, "0 to 1");
  if (!(spec.soot_g_per_kg >= 0 && spec.soot_g_per_kg <= 100))
    return refuse("soot", spec.soot_g_per_kg, "0 to 100 g/kg");
  constexpr double kCarbonKgMol = 12.011e-3, kHydrogenKgMol = 1.008e-3, kSootKgM3 = 1800;
  constexpr double kOxygenInAir = 0.2095;
  // Amounts are per mole of carbon in the fuel.
  const double fuel_kg = kCarbonKgMol + spec.hydrogen_per_carbon * kHydrogenKgMol;
  const double soot_kg = 1e-3 * spec.soot_g_per_kg * fuel_kg, soot_mol = soot_kg / kCarbonKgMol;
  const double co2 = 1 - spec.carbon_as_co - soot_mol;
  if (co2 < 0) return absl::InvalidArgumentError("more carbon in CO and soot than in the fuel");
  const double h2o = spec.hydrogen_per_carbon / 2;
  const double air = (1 + spec.excess_air) * (1 + spec.hydrogen_per_carbon / 4) / kOxygenInAir;
  const double oxygen_used = co2 + spec.carbon_as_co / 2 + h2o / 2;
  const double all = air - oxygen_used + co2 + spec.carbon_as_co + h2o;
  const double volume_m3 = all * kGasConstantJMolK * temperature_k / pressure_pa;
  return ExhaustGas{co2 / all, h2o / all, spec.carbon_as_co / all, soot_kg / kSootKgM3 / volume_m3};
}

}  // namespace irsig
