#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "absl/status/statusor.h"
#include "core/atmosphere/atmosphere.h"
#include "core/environment/weather_spec.h"

namespace irsig {

// Light along single rays through the air of one weather, on all of the air's bands, as the
// conditions of a sweep have it: the mean of a clear and of an overcast sky, by the cover. Without
// a cover, fog or haze that scatters more than once (core/atmosphere/haze_light.h) it is
// Atmosphere::radiance, to the last bit. Immutable.
class WeatherAir {
 public:
  // Makes the air of a weather. The cover lies in [0, 1] and has a cloud unless it is 0. Imported
  // paths are left out. INVALID_ARGUMENT as in Environment::make.
  //   height_m  above the sea: of the point whose surroundings are scattered into paths; held
  //             between 1 m above the surface and 50 km
  [[nodiscard]] static absl::StatusOr<WeatherAir> make(WeatherSpec weather, double height_m);
  WeatherAir(WeatherAir&&) noexcept;
  WeatherAir& operator=(WeatherAir&&) noexcept;
  ~WeatherAir();

  // kDiffuse: of the sky, in which a cloud's forward peak is a part of the light.
  // kSharp: between a sensor and a target, of which all that a cloud scatters is lost.
  // The transmittance is that of kSharp in both.
  enum class Sight { kDiffuse, kSharp };
  // Returns the ray through a profile: that of an overcast sky has the cloud's levels.
  using Ray = std::function<absl::StatusOr<LightPath>(const AirProfile&)>;

  // Computes transmittance and radiance of a ray. The model error of a broken sky has sqrt(cover (1
  // - cover)) times the difference of both skies.
  //   surroundings_w_m2_sr_um  scattered into the ray by air and aerosol, empty: none;
  //                            null: by each of the skies, with the surface below
  [[nodiscard]] absl::StatusOr<PathRadiance> radiance(
      Sight sight, const Ray& ray, const std::optional<SunPlace>& sun,
      const AirSpectrum* surroundings_w_m2_sr_um = nullptr) const;

  // Returns direct sunlight on a plane normal to the beam, at a height. [W m^-2 um^-1]
  [[nodiscard]] AirSpectrum sun_irradiance_w_m2_um(double height_m, const SunPlace& sun) const;

 private:
  struct Parts;
  explicit WeatherAir(std::unique_ptr<const Parts> parts);
  std::unique_ptr<const Parts> parts_;
};

}  // namespace irsig
