#pragma once

#include "core/atmosphere/atmosphere.h"

namespace irsig {

// Returns by how much sunlight that haze scatters exceeds what it scatters once, as a fraction of
// the latter and beyond kAerosolRelativeError: one sigma of the model error of light scattered
// once,
//   exp(0.6 S (1 / cosine + 2)) - 1 - kAerosolRelativeError,    in clear air,
// with the vertical scattering depth S of the particles above a height, the slant of the sun, and
// that of a sky seen 60 deg from the zenith; at most 1e4, as in the densest haze that was
// compared. 0 where that is negative, in air that has clouds, whose light is scattered as often as
// it is, and without particles. In haze whose light is computed as often as it is scattered it is
//   0.14
// of all scattered sunlight, and between both by haze_fraction() (core/atmosphere/haze_light.h). In
// fog without clouds
//   0.65 sin(zenith)^8
// of all scattered sunlight: what is scattered more than once has no azimuth there, so that it is
// too little below a low sun and too much opposite it (tests/physics/fog_light_test.cpp).
//   zenith_deg  of the sun; its cosine is taken to be at least 0.1
//
// Accuracy: against photons followed one by one in rural and maritime haze of 1 to 23 km, the sun
// 30 to 80 deg and the sight 0 to 80 deg from the zenith: 0.6 makes rms z 1 if all haze scatters
// once, and 0.14 makes it 0.78 where it is computed, largest z 3.3
// (tests/physics/haze_light_test.cpp).
[[nodiscard]] AirSpectrum scattered_again_relative(const Atmosphere& atmosphere, double height_m,
                                                   double zenith_deg,
                                                   const BandChoice& bands = BandChoice());

// Returns one sigma of sunlight that a path scatters once with one zenith angle of the sun on all
// of it and the sun's amounts interpolated between heights, as a fraction of that light:
//   0.12 exp(0.81 (zenith angle / deg - 88)), at most 1.5; 0 for suns above 5 deg.
// Towards a sun at the horizon, where the path's far end sees a higher sun, it is too little.
//
// Accuracy: sums over all steps, each with its own sun, 5 and 30 deg above a setting sun
// (tests/physics/environment_twilight_test.cpp).
[[nodiscard]] double low_sun_relative(double zenith_deg);

}  // namespace irsig
