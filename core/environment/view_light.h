#pragma once

#include <vector>

#include "core/environment/sun_light.h"
#include "core/environment/weather_light.h"

namespace irsig {

// The sweep's wavelengths and the air's bands that they lie in. Private to core/environment.
struct NodeWavelengths {
  std::vector<double> um;
  std::vector<std::size_t> band;
  BandChoice bands;
  std::vector<double> solar_shape;  // solar spectrum there over that at the band's centre
};
[[nodiscard]] absl::StatusOr<NodeWavelengths> node_wavelengths(const std::vector<double>& um);

// One weather seen along one line: what all its conditions share. Private to core/environment.
class ViewLight {
 public:
  [[nodiscard]] static absl::StatusOr<ViewLight> make(const WeatherSpec& spec,
                                                      const Atmosphere& atmosphere,
                                                      const WeatherLight& light, double height_m,
                                                      const Environment::Line& line,
                                                      const DirectionNodes& nodes,
                                                      const NodeWavelengths& wavelengths);

  [[nodiscard]] ViewEnvironment seen_under(const SunLight& sun) const;

 private:
  ViewLight(const WeatherLight& light, const Environment::Line& line, const DirectionNodes& nodes,
            const NodeWavelengths& wavelengths);
  void see_sky();
  void see_lower();
  absl::Status take_import(const ImportedPaths& paths, double sensor_height_m, double height_m);
  // On the sweep's wavelengths: band means, carried on inside a band by Planck's function at the
  // target's air temperature or by the sun's spectrum.
  [[nodiscard]] std::vector<double> spread_thermal(const AirSpectrum& thermal) const;
  [[nodiscard]] std::vector<double> plus_solar(std::vector<double> thermal,
                                               const AirSpectrum& solar) const;
  struct Solar {  // what the sun adds, behind near air
    std::vector<AirSpectrum> sky_ratio, lower_air_ratio, lower_surface_ratio;  // [ring]
    AirSpectrum irradiance, scattered;
  };
  [[nodiscard]] Solar solar(const SunLight& sun) const;
  void add_behind(ViewEnvironment& out, const SunLight& sun, const Solar& solar) const;

  const WeatherLight* light_;
  Environment::Line line_;
  const DirectionNodes* nodes_;
  const NodeWavelengths* wavelengths_;
  std::vector<double> thermal_shape_;  // Planck's function there over that at the band's centre

  std::optional<PathLayers> leg_;  // from the sensor to the target
  AirSpectrum transmittance_, path_radiance_;
  bool imported_ = false, imported_radiance_ = false;
  ModelError error_;
  std::vector<AirSpectrum> sky_, lower_;  // apparent thermal radiance, [ring]
  // Thermal radiance at the target and at the sensor, [ring: sky, then lower].
  std::vector<std::vector<double>> ring_, ring_apparent_;
};

}  // namespace irsig
