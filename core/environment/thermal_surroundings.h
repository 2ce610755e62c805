#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/atmosphere/cloud_light.h"
#include "core/atmosphere/haze_light.h"
#include "core/atmosphere/path_layers.h"
#include "core/environment/fit/direction_nodes.h"
#include "core/environment/fit/lazy.h"
#include "core/environment/sea/sea_surface.h"
#include "core/environment/unknown_cloud.h"
#include "core/environment/view_environment.h"
#include "core/environment/weather_spec.h"

namespace irsig {

// The thermal light of one weather at the target, on the air's bands: sky, air below the horizon
// and sea, ring by ring of a set of direction nodes. Private to core/environment.

struct SkyRing {
  double sin_elevation;
  // Null once nothing asks for them any more: ThermalSurroundings::sun_is_made.
  mutable std::shared_ptr<const PathLayers> layers;
  AirSpectrum total;             // [W m^-2 sr^-1 um^-1]
  AirSpectrum model_error = {};  // ThermalSurroundings::model_error_of
};

// The surface below the horizon as seen in one direction, azimuth 0.
struct LowerRing {
  // Reflection by the surface of light from one cell of the sky.
  struct Cell {
    std::uint32_t ring, turn;         // of the sky; steps of azimuth from the direction of sight
    std::vector<double> weight = {};  // share x reflectance; [band that is wanted]
  };
  double sin_elevation;                      // > 0: below the horizontal by so much
  std::shared_ptr<const PathLayers> layers;  // of the air in front of the surface
  mutable std::vector<Cell> cell;            // until the last sun is made; none if it is diffuse
  // Share x reflectance of one node of each of the sky's rings; empty unless the surface is diffuse
  // and grey.
  std::vector<double> diffuse;
  std::vector<AirSpectrum> from_ring;  // the cells' weights, all azimuths together; until `total`
  AirSpectrum emission;                // of the surface, with what it reflects of itself
  std::uint32_t mirrored_ring;         // of the sky, where most of the reflection comes from
  AirSpectrum reflected;               // thermal sky, at the surface
  AirSpectrum reflected_ratio;         // of it at the target, by summed amounts
  AirSpectrum total;                   // at the target
  // Seen by a target in the air: the ray misses the surface, and ends in space. No cells.
  bool limb = false;
  // The air in front of the surface is that of the clear sky, without a cloud's spectra.
  bool below_cloud = false;
};

class ThermalSurroundings {
 public:
  // suns: of how many conditions the sunlight will be asked for: LowerRing::cell and most of
  // SkyRing::layers, most of all that is kept, go with the last of them (sun_is_made).
  //   atmosphere  clear, or with a cloud that covers all of the sky
  //   clear       the same without the cloud, whose air in front of the surface is used where the
  //               cloud lies above it; null: none is known
  ThermalSurroundings(const WeatherSpec& spec, const Atmosphere& atmosphere, double height_m,
                      const DirectionNodes& nodes, const BandChoice& bands, int suns,
                      const ThermalSurroundings* clear = nullptr);

  std::vector<SkyRing> sky;  // rings of the nodes
  std::vector<LowerRing> lower;
  AirSpectrum surroundings;  // mean radiance around, scattered into paths
  AirSpectrum surface_planck;
  // Means over the hemisphere above: radiance, and one sigma of its model.
  AirSpectrum sky_mean, sky_model_error;
  double lower_model_relative = 0;
  double sky_interpolation = 0, lower_interpolation = 0;
  // [ring] Twice the relative error half way to the rings beside it, the larger, in the worst
  // quarter of a micrometre: towards the horizon the largest error is not half way.
  std::vector<double> sky_ring_error, lower_ring_error;

  // Rings of `lower` that miss the surface: the first ones.
  [[nodiscard]] std::size_t limb_rings() const {
    return static_cast<std::size_t>(
        std::count_if(lower.begin(), lower.end(), [](const LowerRing& r) { return r.limb; }));
  }

  // The sky between the horizon and the horizontal, which nothing but a line of sight sees: rings
  // of falling rays that miss the Earth, by kLimb. Made when they are first asked for.
  [[nodiscard]] const std::vector<SkyRing>& limb() const;

  // Notes that one more of the suns needs LowerRing::cell no longer.
  void sun_is_made() const;

  // Air between the target and land at kLandRangeM, level. Made when it is first asked for.
  [[nodiscard]] const std::vector<PathLayers>& land_air() const;
  // Returns the sky's mean radiance over the hemisphere, weighted with the sine of the elevation.
  [[nodiscard]] AirSpectrum sky_on_level() const;

  // Light that the atmosphere's cloud and fog scatter; null without them.
  [[nodiscard]] const CloudLight* cloud() const { return cloud_.get(); }

  // Light that the atmosphere's haze scatters more than once; null where that is left out.
  [[nodiscard]] const HazeLight* haze() const { return haze_.get(); }

  // Unknown properties of the atmosphere's cloud; null: nothing, or there is none.
  [[nodiscard]] const UnknownCloud* unknown_cloud() const {
    return unknown_ ? &*unknown_ : nullptr;
  }

  // Returns surface_model_relative() of the surface below the horizon.
  [[nodiscard]] double surface_relative(double sine) const;
  // Returns one sigma of the model's radiance of a sky's ring.
  [[nodiscard]] AirSpectrum model_error_of(const SkyRing& ring) const;

  // Returns the radiance of the sky's ring through so much air in front, over its own.
  //   through_near  transmittance of that air
  [[nodiscard]] AirSpectrum sky_ratio(std::uint32_t ring, const AbsorberAmounts& near,
                                      const AirSpectrum& through_near) const {
    return ratio_behind(sky[ring], near, through_near);
  }
  [[nodiscard]] AirSpectrum ratio_behind(const SkyRing& ring, const AbsorberAmounts& near,
                                         const AirSpectrum& through_near) const;

 private:
  [[nodiscard]] SkyRing make_sky(double sin_elevation) const;
  // Returns the ring of the lower hemisphere at an elevation.
  //   air  in front of the surface; null: to be computed
  [[nodiscard]] LowerRing make_lower(double sin_elevation,
                                     std::shared_ptr<const PathLayers> air = nullptr) const;
  // Drops the layers of the sky that neither ViewLight nor the sun's light asks for.
  void drop_layers() const;
  // Computes the reflectance of water in the wanted bands.
  void reflect(AirSpectrum& out, double cos_incidence) const;
  void reflect_from_facets(LowerRing& ring, double cos_zenith) const;
  void reflect_diffusely(LowerRing& ring) const;
  // Sets Planck's function in the wanted bands.
  void planck_of(double kelvin, AirSpectrum& out) const;
  // Makes the light of cloud, fog or haze.
  void scatter_again();
  // Returns the surface below the air, for diffuse light.
  [[nodiscard]] GroundBelow ground() const;
  void finish(SkyRing& ring) const;
  void finish(LowerRing& ring) const;
  void solve_surroundings();

  const SurfaceBoundary& spec_;
  const Atmosphere& atmosphere_;
  double height_m_;
  const DirectionNodes& nodes_;
  const BandChoice& bands_;
  bool refraction_;
  std::unique_ptr<const CloudLight> cloud_;
  std::unique_ptr<const HazeLight> haze_;
  std::optional<UnknownCloud> unknown_;
  bool in_the_air_;                             // WeatherSpec::above_surface_m > 0
  WaterSpectrum water_;                         // per band
  std::vector<AirSpectrum> rough_reflectance_;  // at kGrazing
  Lazy<std::vector<SkyRing>> limb_;
  Lazy<std::vector<PathLayers>> land_air_;
  mutable std::atomic<int> suns_to_come_;
};

// Positions of the limb's rings in units of BehindSight::limb, from the horizon up.
inline constexpr std::array kLimb = {1.0, 0.97, 0.92, 0.85, 0.76, 0.65, 0.5, 0.33, 0.16};

// Returns one sigma of a surface's emission and reflection at an angle to it, relative. Larger for
// a rough sea above kMostSlopeWindMS, whose slopes are held there.
[[nodiscard]] double surface_model_relative(const SurfaceBoundary& spec, double sine);

// Returns the weights of rings in a mean over the hemisphere. sine: of the elevation, from 0 to 1.
[[nodiscard]] std::vector<double> ring_weights(const std::vector<double>& sine);

// Weights of a sky's rings in the irradiance of a level surface over pi; they add up to 1.
[[nodiscard]] std::vector<double> level_weights(const std::vector<SkyRing>& sky);

// Returns the sine of the depression at which the sea's horizon lies, seen from a height.
[[nodiscard]] double sin_of_dip(const AirProfile& air, double height_m, bool refraction);

}  // namespace irsig
