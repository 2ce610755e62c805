#include "core/thermal/condensation.h"

#include <algorithm>
#include <cmath>

namespace irsig {
namespace {

constexpr double kDryAdiabatKPerM = 9.76e-3;

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
  return std::clamp(condensation_level_m(air_k, relative_humidity_percent), kLowestCondensationM,
                    kHighestCondensationM);
}

}  // namespace irsig
