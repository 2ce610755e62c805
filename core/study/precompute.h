#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/spectral/band.h"

namespace irsig {

// One condition of the ship paper's precomputation model (Table 3): a target of two flat areas that
// face the sensor, behind homogeneous air.
struct PrecomputeCase {
  double hot_area_m2;
  double hot_temperature_k;
  double ambient_area_m2;
  double ambient_temperature_k;
  double emissivity;                  // of both, [0, 1]
  double reflected_exitance_w_m2_um;  // E: what both areas would reflect at reflectance 1
  double absorption_m2_kg;            // kappa, the same at every wavelength
  double range_m;                     // s
  double pressure_pa;                 // P
  double gas_constant_j_kg_k;         // R
  double air_temperature_k;           // T_e
};

// Computes the apparent spectral radiant intensity I(lambda).            [W sr^-1 um^-1]
//
//   I = sum over both areas of A/pi (eps pi L_b(lambda, T) + (1 - eps) E) exp(-kappa s P / (R T_e))
//                                                           [zhou2026, Eq. 12]
// lambda_um  within the limits of planck.h                  [um]
//
// Accuracy: with Table 3, E = 0 and the one coefficient 1.649e-5 m2/kg the three published peaks
// (14296.29, 16114.02, 19925.48 W/(sr um)) within 0.036 % (tests/physics/precompute_test.cpp); the
// arithmetic itself to 1e-12. Limits: a reproduction of the paper's closed form, not of a ship: no
// aspect, no background, no air emission.
[[nodiscard]] double precompute_spectral_intensity_w_sr_um(const PrecomputeCase& target,
                                                           double lambda_um);

// Computes the spectrum at lambda_min + k step, k = 0 .. n, both limits included (the step is
// adjusted so that it divides the interval, as in BandGrid). INVALID_ARGUMENT names every quantity
// that is not physical.
[[nodiscard]] absl::StatusOr<std::vector<SpectralPoint>> precompute_spectrum(
    const PrecomputeCase& target, double lambda_min_um, double lambda_max_um, double step_um);

}  // namespace irsig
