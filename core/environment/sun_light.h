#pragma once

#include <optional>
#include <vector>

#include "core/environment/weather_light.h"

namespace irsig {

// What the sun of one condition adds to the light at the target, on the air's bands: direct,
// scattered once by the air, mirrored by the sea. All 0 with the sun below the horizon. Private to
// core/environment.
class SunLight {
 public:
  SunLight(const ConditionEnvironment& condition, const WeatherLight& weather,
           const LowerSpec& surface, const Atmosphere& atmosphere, double height_m,
           const DirectionNodes& nodes, const BandChoice& bands);

  [[nodiscard]] bool shines() const { return sun_.has_value(); }
  [[nodiscard]] Vec<Body> direction() const { return direction_; }

  AirSpectrum outside;     // irradiance normal to the beam outside the air
  AirSpectrum irradiance;  // at the target
  // [node of the sky], [node below less sky()]: radiance at the target. Of the sky the best
  // linear fit to the aureole, so that sums over directions keep its energy; of the air below the
  // horizon means over the nodes' hats. The sun that a rough sea mirrors is not in it.
  std::vector<AirSpectrum> sky, lower_air, lower_surface;
  // As WeatherLight's relative errors, of the whole light. Of the sky's: mean over lobes of
  // cos^20, 30 deg wide, of |linear - direct|: narrower features than a surface of slope 0.15
  // mirrors are beneath the nodes.
  double sky_interpolation = 0, lower_interpolation = 0, sky_model_relative = 0;

  // Behind near air: irradiance, and ratios of a ring's radiances to those at the target.
  struct Near {
    AirSpectrum irradiance;
    std::vector<AirSpectrum> lower_air, lower_surface;  // [ring]
  };
  [[nodiscard]] Near behind(const AbsorberAmounts& near, const WeatherLight& weather) const;
  [[nodiscard]] AirSpectrum sky_ratio(std::size_t ring, const AbsorberAmounts& near,
                                      const WeatherLight& weather) const;
  // What a path scatters towards an observer: unit vector from the target to him.
  [[nodiscard]] AirSpectrum scattered_by(const PathLayers& path, Vec<Body> towards) const;

  // In one direction, between two rings (of which the second has the share f), not averaged.
  [[nodiscard]] AirSpectrum sky_towards(Vec<Body> direction, std::size_t ring, double f) const;
  [[nodiscard]] AirSpectrum glint_towards(Vec<Body> direction, std::size_t ring, double f) const;

 private:
  [[nodiscard]] AirSpectrum joined(const AbsorberAmounts& amounts) const;
  [[nodiscard]] std::vector<PhaseMean> phases(const std::vector<double>& sine, double up,
                                              std::uint32_t azimuths) const;
  // Of a grey surface: its reflection of the sun, the same in all directions.
  [[nodiscard]] double diffuse_per_sr() const;
  [[nodiscard]] double sky_error(const WeatherLight& weather, std::uint32_t azimuths) const;

  Vec<Body> direction_;
  double height_m_;
  const LowerSpec& surface_;
  const BandChoice& bands_;
  std::optional<SunAmounts> sun_;
  std::vector<ScatteredSun> sky_source_;  // [ring]
  AirSpectrum near_;                      // transmittance from the sun to the target
  std::vector<AirSpectrum> far_;          // [ring below]: to the surface and back to the target
};

}  // namespace irsig
