#pragma once

#include "core/atmosphere/atmosphere.h"

namespace irsig {

// Scattering of a stretch of a path.
struct StepScattering {
  AirSpectrum aerosol_depth = AirSpectrum(kAirBandCount, 0.0);
  AirSpectrum molecular_depth = AirSpectrum(kAirBandCount, 0.0);
  AirSpectrum asymmetry = AirSpectrum(kAirBandCount, 0.0);  // of the aerosol
  // Depth of all grey extinction, scattering included. It bounds an optical depth whose
  // transmittance has underflowed.
  AirSpectrum grey_depth = AirSpectrum(kAirBandCount, 0.0);
  // Depth and asymmetry of scattering by cloud and fog; empty where the air has neither.
  AirSpectrum cloud_depth, cloud_asymmetry;
};

}  // namespace irsig
