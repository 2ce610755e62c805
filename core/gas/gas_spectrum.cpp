#include "core/gas/gas_spectrum.h"

#include "core/base/status_macros.h"
#include "core/gas/gas_path.h"

namespace irsig {

absl::StatusOr<GasSpectrum> gas_spectrum(std::span<const GasLayer> path, GasBands bands) {
  ASSIGN_OR_RETURN(const GasPath made, GasPath::make(path, bands));
  return made.alone();
}

absl::StatusOr<GasThroughAir> gas_through_air(std::span<const GasLayer> path,
                                              const AbsorberAmounts& air, GasBands bands) {
  ASSIGN_OR_RETURN(const ForegroundAir before, ForegroundAir::make(air, bands));
  ASSIGN_OR_RETURN(const GasPath made, GasPath::make(path, bands));
  return made.through(before);
}

}  // namespace irsig
