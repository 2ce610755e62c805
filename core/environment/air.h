#pragma once

#include <vector>

namespace irsig {

enum class AirModel { kVacuum, kHomogeneous };

// The air between target and sensor. Later models take the place of the homogeneous one behind
// air_path().
struct Air {
  AirModel model = AirModel::kVacuum;
  double absorption_m2_kg = 0;
  double pressure_pa = 0;
  double gas_constant_j_kg_k = 0;
  bool path_emission = false;  // whether the column radiates (1 - transmittance) B(T)
};

// Transmittance and radiance of a line of sight, on the wavelengths asked for:
//   L at the aperture = transmittance L at the target + path_radiance.
struct AirPath {
  std::vector<double> transmittance;
  std::vector<double> path_radiance_w_m2_sr_um;
};

// Homogeneous air obeys Bouguer's law with density P / (R T):                 [zhou2026, eqs. 9-11]
//   transmittance = exp(-absorption P range / (R T))
// The transmittance is taken over the slant range to the target's reference point.
[[nodiscard]] AirPath air_path(const Air& air, double air_temperature_k, double range_m,
                               const std::vector<double>& lambda_um);

// Returns d(-ln transmittance) / d(range), largest over wavelengths. [1/m]
[[nodiscard]] double extinction_per_m(const Air& air, double air_temperature_k);

}  // namespace irsig
