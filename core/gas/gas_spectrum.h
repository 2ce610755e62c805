#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/gas/gas_state.h"

namespace irsig {

// The hot gas's own grid: means over bands of 10 cm-1 from 50 to 9300 cm-1 (1.075-200 um), in order
// of increasing wavenumber. The air's 275 bands (core/atmosphere) are bands 60 to 334 of it.
inline constexpr double kGasFirstCm1 = 50, kGasBandWidthCm1 = 10;
inline constexpr std::size_t kGasBandCount = 925;
[[nodiscard]] double gas_band_centre_cm1(std::size_t band);
[[nodiscard]] double gas_band_lambda_um(std::size_t band);  // 1e4 / centre

// Neighbouring bands, one beyond the last.
struct GasBands {
  std::size_t first = 0, last = kGasBandCount;
  [[nodiscard]] std::size_t size() const { return last - first; }
};

// What gas along a line of sight does to what lies behind it, L = T L_behind + radiance.
struct GasSpectrum {
  GasBands bands;
  std::vector<double> transmittance;        // [band - bands.first]
  std::vector<double> absorptance;          // 1 - T, with all its digits where the gas is thin
  std::vector<double> radiance_w_m2_sr_um;  // at the first segment's near end, at the band's centre
};

// Absorption and emission without scattering, gases as factors, each gas's layers of different
// temperature by Curtis and Godson (curve_of_growth.h); a segment is isothermal:
//   L = sum over segments of (T_before - T_after) B(T_segment)
//
//   path  from the eye outwards; segments of length 0 count for nothing
//
// Errors: those of check_gas, with the segment's number (from 1); INVALID_ARGUMENT for bands that
// do not exist. Accuracy and limits: docs/methods/gas.md.
[[nodiscard]] absl::StatusOr<GasSpectrum> gas_spectrum(std::span<const GasSegment> path,
                                                       GasBands bands = {});

}  // namespace irsig
