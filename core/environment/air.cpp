#include "core/environment/air.h"

#include <cmath>

#include "core/spectral/planck.h"

namespace irsig {

double extinction_per_m(const Air& air, double air_temperature_k) {
  if (air.model == AirModel::kVacuum) return 0;
  return air.absorption_m2_kg * air.pressure_pa / (air.gas_constant_j_kg_k * air_temperature_k);
}

AirPath air_path(const Air& air, double air_temperature_k, double range_m,
                 const std::vector<double>& lambda_um) {
  const double optical_depth = extinction_per_m(air, air_temperature_k) * range_m;
  AirPath out{std::vector<double>(lambda_um.size(), std::exp(-optical_depth)),
              std::vector<double>(lambda_um.size(), 0.0)};
  if (air.path_emission)
    for (std::size_t i = 0; i < lambda_um.size(); ++i)
      out.path_radiance_w_m2_sr_um[i] =
          -std::expm1(-optical_depth) * planck_radiance_w_m2_sr_um(lambda_um[i], air_temperature_k);
  return out;
}

}  // namespace irsig
