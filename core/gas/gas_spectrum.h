#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/atmosphere/absorber_amounts.h"
#include "core/gas/gas_state.h"

namespace irsig {

// The hot gas's own grid: means over bands of 10 cm-1 from 50 to 9300 cm-1 (1.075-200 um), in order
// of increasing wavenumber. The air's 275 bands (core/atmosphere) are bands 60 to 334 of it.
inline constexpr double kGasFirstCm1 = 50, kGasBandWidthCm1 = 10;
inline constexpr std::size_t kGasBandCount = 925;
[[nodiscard]] double gas_band_centre_cm1(std::size_t band);
[[nodiscard]] double gas_band_lambda_um(std::size_t band);  // 1e4 / centre
// OUT_OF_RANGE outside [1e4 / 9300, 1e4 / 50] um.
[[nodiscard]] absl::StatusOr<std::size_t> gas_band(double lambda_um);
// Edges of the bands between two wavelengths, increasing: where spectra jump. [um]
[[nodiscard]] std::vector<double> gas_band_edges_um(double lambda_min_um, double lambda_max_um);

// Neighbouring bands, one beyond the last.
struct GasBands {
  std::size_t first = 0, last = kGasBandCount;
  [[nodiscard]] std::size_t size() const { return last - first; }
};

// Transmittance and radiance of gas along a line of sight, L = T L_behind + radiance.
struct GasSpectrum {
  GasBands bands;
  std::vector<double> transmittance;        // [band - bands.first]
  std::vector<double> absorptance;          // 1 - T, with all its digits where the gas is thin
  std::vector<double> radiance_w_m2_sr_um;  // at the first segment's near end, at the band's centre
};

// Absorption and emission without scattering, gases as factors; a segment is isothermal:
//   L = sum over segments of (T_before - T_after) B(T_segment)
// Layers of different temperature: carbon dioxide at 1970-2460 and monoxide at 1750-2350 cm-1 bin
// by bin (hot_lines.h), all else by Curtis and Godson (gas_loops.h).
//
//   path  from the eye outwards; segments of length 0 count for nothing
//
// Errors: those of check_gas, with the segment's number (from 1); INVALID_ARGUMENT for bands that
// do not exist. Accuracy and limits: docs/explanation/methods/gas.md.
[[nodiscard]] absl::StatusOr<GasSpectrum> gas_spectrum(std::span<const GasLayer> path,
                                                       GasBands bands = {});

// Like gas_spectrum(), as seen through air that lies between the eye and the path. `radiance` is
// the arriving radiance, `transmittance` that of air and gas together, `absorptance` the fraction
// of the air's transmittance that the gas absorbs. Where lines are shared, no result is a product
// of band means: carbon dioxide (2140-2430 cm-1) and monoxide (1900-2300) use common terms, water
// lies between ranked and product (water_through_air.h).
struct GasThroughAir {
  GasSpectrum spectrum;
  std::vector<double> air_transmittance;  // without the gas
  // One sigma of the radiance because the share of water's lines that hot and cold gas have in
  // common is not known better.                                          [W m^-2 sr^-1 um^-1]
  std::vector<double> water_correlation_error_w_m2_sr_um;
};

// The air's bands among the gas's own.
inline constexpr GasBands kAirGasBands = {60, 335};

// Errors: as above, and INVALID_ARGUMENT for bands that the air has not.
[[nodiscard]] absl::StatusOr<GasThroughAir> gas_through_air(std::span<const GasLayer> path,
                                                            const AbsorberAmounts& air,
                                                            GasBands bands = kAirGasBands);

}  // namespace irsig
