#pragma once

#include <array>
#include <vector>

#include "core/atmosphere/atmosphere.h"
#include "core/atmosphere/cloud_light.h"
#include "core/atmosphere/haze_column.h"
#include "core/atmosphere/path_layers.h"

namespace irsig {

// Returns the fraction of the light scattered more than once by haze that is computed: 0 up to a
// vertical scattering depth of the particles at 3.84 um of kHazeFromDepth, 1 from kHazeFullDepth
// on, and a cubic without a bend in between. It is 0 without particles, and in air that has fog or
// clouds, which have light of their own (core/atmosphere/cloud_light.h).
//
// Maritime haze of 23 km of visibility has a depth of 0.09 to 0.14, of 10 km one of 0.22 to 0.36;
// rural haze of 2 km has 0.25.
[[nodiscard]] double haze_fraction(const Atmosphere& atmosphere);
inline constexpr double kHazeFromDepth = 0.14, kHazeFullDepth = 0.2;

// Levels of the column, at most.
inline constexpr std::size_t kHazeLevels = 14;

// Light that haze scatters more than once, from successive orders in a column of layers
// (core/atmosphere/haze_column.h) between the ground and 10 km above it, below clear air.
// Immutable.
//
// The air's lines are grey in a band, as strong as in a vertical path from the ground on. Molecules
// do not scatter.
class HazeLight {
 public:
  //   fraction  haze_fraction(), above 0
  HazeLight(const Atmosphere& atmosphere, const GroundBelow& ground, double fraction,
            bool refraction, const BandChoice& bands);

  [[nodiscard]] double fraction() const { return fraction_; }

  // Returns the thermal light that particles at a height scatter into a direction, per unit of
  // their scattering depth, never negative; above the column that of its top.
  //   cosine  of the zenith angle in which the light travels
  [[nodiscard]] AirSpectrum thermal(double height_m, double cosine) const;

 private:
  friend class HazeSunlight;
  // Returns the place of a level's source in a wanted band.
  [[nodiscard]] std::size_t place(std::size_t level, std::size_t band) const {
    return level * columns_ + rank_[band];
  }

  BandChoice bands_;
  double fraction_;
  std::vector<std::size_t> rank_;                 // [band] its number among those that are wanted
  std::size_t columns_ = 0;                       // how many are wanted
  std::vector<double> height_m_;                  // of the levels, increasing
  std::vector<std::vector<StreamLayer>> column_;  // [band] from the top down
  AirSpectrum albedo_below_;
  std::vector<std::array<double, kHazeMoments>> thermal_;  // [level][band]
};

// Sunlight that haze scatters into the directions of one zenith angle, per unit of scattering
// depth: the sum over m of mode[m] x cos(m azimuth from the sun's), and around the sun `peak` x the
// phase function of `peak_asymmetry`.  [1/sr]
struct HazeSunSource {
  std::array<AirSpectrum, kHazeModes> mode;
  AirSpectrum peak, peak_asymmetry;
};

// Sunlight that haze scatters more than once, for one sun outside the air of irradiance 1 normal to
// the beam.
class HazeSunlight {
 public:
  // Bytes that a sun keeps for each wanted band.
  static constexpr double kBytesPerBand = kHazeLevels * sizeof(HazeSource);

  //   haze        outlives the object
  //   atmosphere  the haze's
  //   zenith_deg  of the sun
  HazeSunlight(const HazeLight& haze, const Atmosphere& atmosphere, double zenith_deg);

  // Returns the source at a height; above the column that of its top.
  //   cosine  of the zenith angle in which the light travels
  [[nodiscard]] HazeSunSource at(double height_m, double cosine) const;
  [[nodiscard]] double sun_cosine() const { return sun_cosine_; }
  [[nodiscard]] double fraction() const { return haze_->fraction(); }

 private:
  const HazeLight* haze_;
  double sun_cosine_;
  std::vector<HazeSource> source_;  // [level][band]
};

}  // namespace irsig
