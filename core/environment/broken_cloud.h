#pragma once

#include "core/atmosphere/absorber_amounts.h"
#include "core/environment/view_environment.h"

namespace irsig {

// Light under a sky of which clouds cover a part: the mean of that under a clear and under an
// overcast sky. Under any one of them a target has the one or the other; the standard deviation of
// this choice, sqrt(cover (1 - cover)) times their difference, is added to the models' errors.
// Private to core/environment, as all of this header.
//   sky_relative  that of the sky's mean radiance, relative: broken_cloud_relative
[[nodiscard]] ViewEnvironment under_broken_cloud(const ViewEnvironment& clear,
                                                 const ViewEnvironment& overcast, double cover,
                                                 double sky_relative);
// Mean of the bounds.
[[nodiscard]] LightBounds under_broken_cloud(const LightBounds& clear, const LightBounds& overcast,
                                             double cover);

// Standard deviation of the mixture of two spectra over their mean, averaged over the bands.
[[nodiscard]] double broken_cloud_relative(const AirSpectrum& clear, const AirSpectrum& overcast,
                                           double cover);

}  // namespace irsig
