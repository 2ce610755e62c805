#pragma once

#include <cstddef>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// The hot gas's own grid: means over bands of 10 cm-1 from 50 to 9300 cm-1 (1.075-200 um), in order
// of increasing wavenumber. The air's 275 bands (core/atmosphere) are bands 60 to 334 of it.
inline constexpr double kGasFirstCm1 = 50, kGasBandWidthCm1 = 10;
inline constexpr std::size_t kGasBandCount = 925;
[[nodiscard]] double gas_band_centre_cm1(std::size_t band);
[[nodiscard]] double gas_band_lambda_um(std::size_t band);  // 1e4 / centre
// Returns the band of a wavelength. OUT_OF_RANGE outside [1e4 / 9300, 1e4 / 50] um.
[[nodiscard]] absl::StatusOr<std::size_t> gas_band(double lambda_um);
// Returns the edges of the bands between two wavelengths, increasing: where spectra jump. [um]
[[nodiscard]] std::vector<double> gas_band_edges_um(double lambda_min_um, double lambda_max_um);

// Neighbouring bands, one beyond the last.
struct GasBands {
  std::size_t first = 0, last = kGasBandCount;
  [[nodiscard]] std::size_t size() const { return last - first; }
};

// The air's bands among the gas's own.
inline constexpr GasBands kAirGasBands = {60, 335};

}  // namespace irsig
