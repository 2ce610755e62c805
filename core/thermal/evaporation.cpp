#include "core/thermal/evaporation.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"

namespace irsig {
namespace {

constexpr double kHeatOfAirJKgK = 1005, kGasOfAirJKgK = 287.04, kVapourToAir = 0.622;

}  // namespace

absl::Status check_water(const SurfaceWater& water) {
  const auto wrong = [](const char* name, double value, const char* expected) {
    return absl::InvalidArgumentError(absl::StrCat(name, " = ", value, ", expected ", expected));
  };
  if (!(water.moisture >= 0 && water.moisture <= 1))
    return wrong("surface_moisture", water.moisture, "0 (dry) to 1 (as wet as water)");
  if (!water.canopy) return absl::OkStatus();
  const auto& [leaf_area_index, stomatal_resistance_s_m] = *water.canopy;
  if (!(leaf_area_index > 0 && leaf_area_index <= 20))
    return wrong("leaf_area_index", leaf_area_index, "above 0, up to 20");
  if (!(stomatal_resistance_s_m >= 10 && stomatal_resistance_s_m <= 1e4))
    return wrong("stomatal_resistance_s_m", stomatal_resistance_s_m, "10 to 10000");
  return absl::OkStatus();
}

Evaporation evaporation_of(const SurfaceWater& water) {
  const double cover = water.canopy ? -std::expm1(-0.5 * water.canopy->leaf_area_index) : 0;
  return {true, (1 - cover) * water.moisture, cover};
}

double inverse_gamma_k_pa(double air_k, double pressure_pa) {
  const double latent_j_kg = 2.501e6 - 2361 * (air_k - 273.15);  // [allen1998, eq. 3-1]
  return kVapourToAir * latent_j_kg / (kHeatOfAirJKgK * pressure_pa);
}

double stomatal_w_m2_k(const Canopy& canopy, double sunlight_w_m2, double air_k,
                       double pressure_pa) {
  constexpr double kHalfOpenWM2 = 104.4, kFullWM2 = 1000;
  const double open = std::min(
      1.0, sunlight_w_m2 * (kFullWM2 + kHalfOpenWM2) / (kFullWM2 * (sunlight_w_m2 + kHalfOpenWM2)));
  const double air_j_m3_k = kHeatOfAirJKgK * pressure_pa / (kGasOfAirJKgK * air_k);
  return air_j_m3_k * open * 0.5 * canopy.leaf_area_index / canopy.stomatal_resistance_s_m;
}

}  // namespace irsig
