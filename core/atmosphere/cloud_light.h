#pragma once

#include <vector>

#include "core/atmosphere/atmosphere.h"
#include "core/atmosphere/path_layers.h"

namespace irsig {

// Surface below an atmosphere's cloud, for diffuse light.
struct GroundBelow {
  AirSpectrum planck;       // of its temperature  [W m^-2 sr^-1 um^-1]
  AirSpectrum reflectance;  // diffuse, [0, 1]
};

// Thermal light inside the cloud of one atmosphere: the mean over all directions of the radiance
// that its particles scatter, from two streams (core/atmosphere/two_stream.h) between the clear air
// above the cloud and the surface behind the air below it. Immutable.
//
// The air's lines inside the cloud are grey in a band, as strong as in a vertical path from the
// cloud's base on. Light of other boundaries has the air of a ray 53 deg from the vertical.
class CloudLight {
 public:
  //   atmosphere  with a cloud whose forward peak stays in the beam; outlives the object
  CloudLight(const Atmosphere& atmosphere, const GroundBelow& ground, bool refraction,
             const BandChoice& bands);

  // Mean radiance at a height; outside the cloud that of the nearest boundary.
  [[nodiscard]] AirSpectrum thermal(double height_m) const;

  // Optical properties of the column, for the sun of a condition.
  struct Level {
    double height_m;
    AirSpectrum depth;       // optical, from the cloud's base up to here, all absorbers
    AirSpectrum scattering;  // the cloud's part of it
    AirSpectrum thermal;
  };
  [[nodiscard]] const std::vector<Level>& level() const { return level_; }
  // Diffuse reflectance of what lies below the cloud, seen from its base.
  [[nodiscard]] const AirSpectrum& albedo_below() const { return albedo_below_; }
  [[nodiscard]] const AirSpectrum& asymmetry() const { return asymmetry_; }
  [[nodiscard]] const BandChoice& bands() const { return bands_; }

 private:
  BandChoice bands_;
  std::vector<Level> level_;  // from the base up
  AirSpectrum albedo_below_, asymmetry_;
};

// Sunlight inside the cloud, without the beam: the mean over all directions of its radiance, for
// one sun outside the air of irradiance 1 normal to the beam.
class CloudSunlight {
 public:
  //   sun         amounts of the sun's paths, with the cloud
  //   zenith_deg  of the sun, above the cloud
  CloudSunlight(const CloudLight& cloud, const SunAmounts& sun, double zenith_deg);

  [[nodiscard]] AirSpectrum mean_per_sr(double height_m) const;

 private:
  std::vector<double> height_m_;
  std::vector<AirSpectrum> mean_per_sr_;
};

}  // namespace irsig
