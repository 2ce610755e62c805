#pragma once

#include <vector>

#include "core/atmosphere/path_layers.h"
#include "core/environment/view_environment.h"
#include "core/environment/weather_spec.h"

namespace irsig {

// The sweep's wavelengths and the air's bands that they lie in. Private to core/environment, as all
// of this header.
struct NodeWavelengths {
  std::vector<double> um;
  std::vector<std::size_t> band;
  BandChoice bands;
  std::vector<double> solar_shape;  // solar spectrum there over that at the band's centre
  // The bands that any wavelength lies in, increasing, and [wavelength] which of them it is.
  std::vector<std::uint32_t> used;
  std::vector<std::uint32_t> used_band;
  [[nodiscard]] std::vector<double> of_used(const AirSpectrum& of_band) const;
};
[[nodiscard]] absl::StatusOr<NodeWavelengths> node_wavelengths(const std::vector<double>& um);

// The ray on which a sensor sees the target in the air of one weather, and the path that was
// imported for it.
struct SensorRay {
  LightPath path;  // from the sensor to the target
  double sensor_height_m = 0;
  double lift_rad = 0;  // by how much it points lower at the target than the straight line
  const ImportedPath* imported = nullptr;
};
// Finds the ray from a sensor. INVALID_ARGUMENT as in Environment::view().
[[nodiscard]] absl::StatusOr<SensorRay> sensor_ray(const WeatherSpec& spec,
                                                   const Atmosphere& atmosphere, double height_m,
                                                   const SensorLine& line, const BandChoice& bands);

// Returns the ray to another place of the target, without imported air. A place that the Earth
// hides is replaced by the lowest visible one above it.
[[nodiscard]] SensorRay end_path(const WeatherSpec& spec, const Atmosphere& atmosphere,
                                 double height_m, const SensorRay& line,
                                 const SensorLine::End& end);

// Returns the ray that goes on along a line of sight beyond the target, to land at a range from the
// sensor. Land below the surface of the weather counts as that surface.
[[nodiscard]] SensorRay land_path(const WeatherSpec& spec, const Atmosphere& atmosphere,
                                  double height_m, const SensorRay& line, const SensorLine& sight,
                                  double range_m);

// The air of one weather between sensor and target.
class SensorPath {
 public:
  //   cloud  light that the atmosphere's cloud scatters; null: it has no cloud
  SensorPath(const SensorRay& path, const Atmosphere& atmosphere, double height_m,
             const NodeWavelengths& wavelengths, const CloudLight* cloud = nullptr,
             const HazeLight* haze = nullptr);

  PathLayers layers;          // the embedded model's
  AirSpectrum transmittance;  // that, or the imported
  bool imported = false, imported_radiance = false;
  double lowest_m = 0, highest_m = 0;

  // Returns the path's radiance from its own emission and its surroundings' mean radiance.
  [[nodiscard]] AirSpectrum radiance(const AirSpectrum* surroundings) const;

  // Returns values on the sweep's wavelengths: unchanged, or band means that follow Planck's
  // function at the target's air temperature, or the sun's spectrum, inside a band.
  [[nodiscard]] std::vector<double> per_wavelength(const AirSpectrum& of_band) const;
  [[nodiscard]] std::vector<double> spread_thermal(const AirSpectrum& thermal) const;
  [[nodiscard]] std::vector<double> plus_solar(std::vector<double> thermal,
                                               const AirSpectrum& solar) const;
  // Shapes by which spread_thermal() and plus_solar() interpolate inside a band.
  [[nodiscard]] IncidentRadiance::Shapes shapes() const;

 private:
  const NodeWavelengths* wavelengths_;
  const ImportedPath* import_;
  std::vector<double> thermal_shape_;  // Planck's function there over that at the band's centre
};

}  // namespace irsig
