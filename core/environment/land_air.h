#pragma once

#include <array>
#include <vector>

namespace irsig {

// Ranges at which the air between a target and the land around it is known; between two of them
// what arrives is linear in the range. [m]
inline constexpr std::array kLandRangeM = {1.0,    30.0,   60.0,   125.0,  250.0,  500.0, 1000.0,
                                           2000.0, 4000.0, 8000.0, 16e3,   32e3,   64e3};

// Air in front of land at one range, and the light that falls on land there and is reflected by it.
// On the sweep's wavelengths. A Lambertian surface of emissivity e and temperature T, whose normal
// has the cosine c to the sun, has the radiance
//   transmittance e B(T) + path_radiance + (1 - e) (sky + c sun / pi)
struct LandAir {
  using Spectrum = std::vector<double>;
  Spectrum transmittance;  // of the land's emission
  Spectrum path_radiance;  // emitted and scattered by the air in front of the land [W/(m2 sr um)]
  // Mean radiance of the sky, weighted with the cosine of a level surface, times the transmittance
  // of the air in front for its lines. [W/(m2 sr um)]
  Spectrum sky;
  Spectrum sun;  // irradiance normal to the beam, likewise; 0: no sun [W/(m2 um)]
};

// The air between land and whoever sees it.
struct LandLight {
  // [kLandRangeM] From the target, at the target and as much of it as arrives at the sensor.
  std::vector<LandAir> at_target, apparent;
  // [SensorLine::land_range_m] From the sensor, at the sensor; path_radiance is net of the air
  // between target and sensor, and negative for land in front of the target.
  std::vector<LandAir> behind;
};

}  // namespace irsig
