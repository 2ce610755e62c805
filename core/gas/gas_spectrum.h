#pragma once

#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/atmosphere/absorber_amounts.h"
#include "core/gas/gas_bands.h"
#include "core/gas/gas_state.h"

namespace irsig {

// Transmittance and radiance of gas along a line of sight, L = T L_behind + radiance.
struct GasSpectrum {
  GasBands bands;
  std::vector<double> transmittance;        // [band - bands.first]
  std::vector<double> absorptance;          // 1 - T, with all its digits where the gas is thin
  std::vector<double> radiance_w_m2_sr_um;  // at the first segment's near end, at the band's centre
};

// Computes absorption and emission without scattering, gases as factors; a segment is isothermal:
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

// Computes the spectrum behind air. Errors: as above, and INVALID_ARGUMENT for bands that the air
// has not.
[[nodiscard]] absl::StatusOr<GasThroughAir> gas_through_air(std::span<const GasLayer> path,
                                                            const AbsorberAmounts& air,
                                                            GasBands bands = kAirGasBands);

}  // namespace irsig
