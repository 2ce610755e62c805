#pragma once

#include <vector>

#include "core/atmosphere/atmosphere.h"
#include "core/atmosphere/path_layers.h"

namespace irsig {

// Surface below cloud or fog, for diffuse light.
struct GroundBelow {
  AirSpectrum planck;       // of its temperature  [W m^-2 sr^-1 um^-1]
  AirSpectrum reflectance;  // diffuse, [0, 1]
};

// Light that particles scatter, per unit of their scattering depth: mean + slope x cosine, of the
// zenith angle of the direction in which the light then travels.
struct ScatteredRadiance {
  AirSpectrum mean, slope;  // slope: of particles without their forward peak
  AirSpectrum asymmetry;    // of these
  AirSpectrum second;       // StreamLight::second, before it is scattered

  // Returns the scattered radiance towards a direction, never negative.
  //   peak  of the particles in the ray: with all that they scatter the slope and the second moment
  //         are those of the whole phase function; without the peak the second moment is 0
  [[nodiscard]] AirSpectrum towards(double cosine, ForwardPeak peak) const;
};

// Thermal light that the particles of an atmosphere's cloud or fog scatter, from two streams
// (core/atmosphere/two_stream.h) between the clear air above and the surface behind the air below;
// in fog without a cloud refined (core/atmosphere/refine_streams.h). Immutable.
//
// The air's lines inside are grey in a band, as strong as in a vertical path from the lowest level
// on. Light of other boundaries has the air of a ray 53 deg from the vertical.
class CloudLight {
 public:
  //   atmosphere  with cloud or fog whose forward peak stays in the beam; outlives the object
  CloudLight(const Atmosphere& atmosphere, const GroundBelow& ground, bool refraction,
             const BandChoice& bands);

  // Returns the thermal light at a height; outside the levels that of the nearest boundary.
  [[nodiscard]] ScatteredRadiance thermal(double height_m) const;

  // Optical properties of the column, for the sun of a condition.
  struct Level {
    double height_m;
    AirSpectrum depth;       // optical, from the lowest level up to here, all absorbers
    AirSpectrum scattering;  // the part of it by cloud and fog
    AirSpectrum asymmetry;   // of that in the layer below; of the lowest in the one above
    ScatteredRadiance thermal;
  };
  [[nodiscard]] const std::vector<Level>& level() const { return level_; }
  // Diffuse reflectance of what lies below, seen from the lowest level.
  [[nodiscard]] const AirSpectrum& albedo_below() const { return albedo_below_; }
  [[nodiscard]] const BandChoice& bands() const { return bands_; }
  // Returns true if the light is that of core/atmosphere/refine_streams.h: in fog without a cloud.
  [[nodiscard]] bool refined() const { return refined_; }

 private:
  BandChoice bands_;
  bool refined_;
  // Sets the levels' depths, scattering and asymmetry.
  void set_levels(const Atmosphere& atmosphere);

  std::vector<Level> level_;  // from the lowest up
  AirSpectrum albedo_below_;
};

// Sunlight that cloud or fog scatter, without that of the beam, for one sun outside the air of
// irradiance 1 normal to the beam.
class CloudSunlight {
 public:
  //   sun         amounts of the sun's paths, with cloud and fog
  //   zenith_deg  of the sun, above them
  CloudSunlight(const CloudLight& cloud, const SunAmounts& sun, double zenith_deg);

  // Returns the scattered sunlight at a height. [1/sr]
  [[nodiscard]] ScatteredRadiance scattered(double height_m) const;

 private:
  std::vector<double> height_m_;
  std::vector<ScatteredRadiance> scattered_;
};

}  // namespace irsig
