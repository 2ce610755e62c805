#include "core/thermal/condensation.h"

#include <algorithm>
#include <cmath>

#include "core/thermal/clear_sky.h"

namespace irsig {
namespace {

constexpr double kDryAdiabatKPerM = 9.76e-3;
constexpr double kGravityMS2 = 9.80665;
constexpr double kDryAirJKgK = 287.04;      // gas constant
constexpr double kHeatCapacityJKgK = 1005;  // of dry air at constant pressure
constexpr double kVapourJKg = 2.501e6;      // heat of evaporation at 0 deg C
constexpr double kVapourOverAir = 0.622;    // molar masses

// Decrease of the temperature of saturated rising air with height.  [K/m]
double saturated_lapse_k_per_m(double air_k, double pressure_pa) {
  const double vapour_pa = vapour_pressure_pa(air_k);
  const double mixing = kVapourOverAir * vapour_pa / std::max(pressure_pa - vapour_pa, vapour_pa);
  const double heat = kVapourJKg * mixing / (kDryAirJKgK * air_k);
  return kGravityMS2 * (1 + heat) /
         (kHeatCapacityJKgK + heat * kVapourJKg * kVapourOverAir / air_k);
}

}  // namespace

double condensation_temperature_k(double air_k, double relative_humidity_percent) {
  constexpr double kDriestPercent = 0.1;
  const double share = std::clamp(relative_humidity_percent, kDriestPercent, 100.0) / 100;
  return 1 / (1 / (air_k - 55) - std::log(share) / 2840) + 55;
}

double condensation_level_m(double air_k, double relative_humidity_percent) {
  return std::max(0.0, air_k - condensation_temperature_k(air_k, relative_humidity_percent)) /
         kDryAdiabatKPerM;
}

double condensed_base_m(double air_k, double relative_humidity_percent) {
  return std::clamp(kBaseOverCondensation * condensation_level_m(air_k, relative_humidity_percent),
                    kLowestCondensationM, kHighestCondensationM);
}

double risen_air_k(double air_k, double relative_humidity_percent, double pressure_pa,
                   double height_m) {
  constexpr double kStepM = 50;
  double at_m = std::min(height_m, condensation_level_m(air_k, relative_humidity_percent));
  double risen_k = air_k - kDryAdiabatKPerM * at_m;
  while (at_m < height_m) {
    const double step_m = std::min(kStepM, height_m - at_m);
    const double there_pa =
        pressure_pa * std::exp(-kGravityMS2 * at_m / (kDryAirJKgK * 0.5 * (air_k + risen_k)));
    risen_k -= step_m * saturated_lapse_k_per_m(risen_k, there_pa);
    at_m += step_m;
  }
  return risen_k;
}

}  // namespace irsig
