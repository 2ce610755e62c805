#pragma once

#include <optional>
#include <vector>

#include "core/atmosphere/atmosphere.h"
#include "core/atmosphere/path_layers.h"
#include "core/environment/weather_spec.h"

namespace irsig {

// Model errors by what is not known of a cloud: its base (WeatherSpec::cloud_base_range_m) and its
// water path (WeatherSpec::cloud_water_range). Each error is the largest change of the light by an
// end of the range over the square root of 3, as if all values between the ends were as probable.
// Both are added in squares. Immutable. Private to core/environment.
class UnknownCloud {
 public:
  // Returns nullopt if all is known, or the atmosphere has no cloud.
  //   overcast  atmosphere of the weather with its cloud
  [[nodiscard]] static std::optional<UnknownCloud> of(const WeatherSpec& weather,
                                                      const Atmosphere& overcast,
                                                      const BandChoice& bands);

  // Returns one sigma of the sky's thermal radiance along a path, 0 for one that falls.
  //
  // Base: that of a black cloud, (B' - B) times the transmittance of the air in front of it. Water:
  // the cloud's emission changes by (1 - t') / (1 - t) - 1 and what it lets pass by t' / t - 1,
  // with its transmittances t and t' for light whose forward peak stays in the beam.
  [[nodiscard]] AirSpectrum sky_error(const PathLayers& path) const;

  // Returns one sigma of the sun's beam at a height, relative, the mean over the bands; 0 above the
  // cloud.
  //   irradiance, outside  at the height, and outside the air
  [[nodiscard]] double beam_relative(const AirSpectrum& irradiance, const AirSpectrum& outside,
                                     double height_m, double zenith_deg) const;
  // Returns one sigma of the sunlight that the cloud scatters down to a height, relative: two
  // streams through the part of the cloud above it alone; 0 above the cloud.
  [[nodiscard]] AirSpectrum diffuse_sun_relative(double height_m, double zenith_deg) const;

  // Adds the errors of a path between two heights, of whose light all that the cloud scatters is
  // lost.
  //   transmittance  of the path
  void add_to(ModelError& error, const AirSpectrum& transmittance, double low_m, double high_m,
              double range_m) const;

 private:
  // Returns the part of the layer's depth that is above a height.
  [[nodiscard]] double part_above(double height_m) const;
  // Spectrum of the layer, straight up.
  struct Depth {
    AirSpectrum absorption, scattering, asymmetry;
    [[nodiscard]] double extinction(std::size_t band) const {
      return absorption[band] + scattering[band];
    }
  };
  double base_m_ = 0, top_m_ = 0;        // as the profile counts heights
  AirSpectrum planck_;                   // at the base
  std::vector<AirSpectrum> other_base_;  // Planck's function at the bases that it may have
  std::vector<double> other_water_;      // multiples of its own
  Depth diffuse_, beam_;
};

}  // namespace irsig
