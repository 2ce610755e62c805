#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/environment/fit/lazy.h"
#include "core/environment/sensor_path.h"
#include "core/environment/thermal_surroundings.h"

namespace irsig {

// The light that the sun of one condition adds at the target, on the air's bands: direct, scattered
// once by the air, mirrored by the sea. What the air scatters is that of the whole disk, which
// lights the air above when the target sees a part of it or, in twilight, nothing; all else is then
// less or 0. Light that is not asked for is not computed. Private to core/environment.
class SunLight {
 public:
  // All arguments outlive the object.
  //   beam  the atmosphere for what arrives in the beam: other than `atmosphere` with a cloud
  SunLight(const ConditionEnvironment& condition, const SunSeen& seen,
           const ThermalSurroundings& weather, const SurfaceBoundary& surface,
           const Atmosphere& atmosphere, const Atmosphere& beam, double height_m,
           const DirectionNodes& nodes, const NodeWavelengths& wavelengths);

  [[nodiscard]] bool shines() const { return sun_.has_value(); }
  [[nodiscard]] Vec<Body> direction() const { return direction_; }
  [[nodiscard]] std::uint32_t azimuths() const { return azimuths_; }

  double visible;          // share of the disk that has not set; 0 in twilight
  AirSpectrum outside;     // irradiance normal to the beam outside the air, of what has not set
  AirSpectrum irradiance;  // at the target, of the whole disk: what has set is left to who sees it

  // Returns the spectrum by which bands of scattered sunlight count: `irradiance`, or in twilight
  // that outside the air.
  [[nodiscard]] const AirSpectrum& shape() const { return visible > 0 ? irradiance : whole_; }

  // Radiance at the target; only where it shines. Of the sky the best linear fit to the aureole, so
  // that sums over directions keep its energy; of the air below the horizon means over the nodes'
  // hats. The sun that a rough sea mirrors is not in it.
  struct Around {
    // On NodeWavelengths::used. Its errors: above the horizon the largest of the linear radiance in
    // any direction of the cells around a node that was looked at; below twice what the differences
    // from the nodes beside it say of straight lines.
    std::shared_ptr<const IncidentRadiance::Sunlight> light;
    // Relative error of the sky's light between nodes: mean over lobes of cos^20, 30 deg wide, of
    // |linear - direct|. Features narrower than a surface of slope 0.15 mirrors are finer than the
    // nodes.
    double interpolation = 0;
    // The sky with its own light and the sun's: as ThermalSurroundings::sky_mean and
    // sky_model_error.
    AirSpectrum sky_mean, sky_model_error;
  };
  [[nodiscard]] const Around& around() const;

  // Returns the transmittance from the sun to the target and through further air.
  [[nodiscard]] AirSpectrum joined(const AbsorberAmounts& amounts) const;
  // Behind near air: ratios of a ring's radiances to those at the target.
  struct LowerRatio {
    AirSpectrum air, surface;
  };
  // Returns the ratios of a ring of the lower hemisphere.
  //   near_end  joined(near)
  [[nodiscard]] LowerRatio lower_ratio(std::size_t ring, const AbsorberAmounts& near,
                                       const AirSpectrum& near_end) const;
  [[nodiscard]] AirSpectrum sky_ratio(std::size_t ring, const AbsorberAmounts& near) const;
  // Returns the sunlight that a path scatters towards an observer, given the unit vector from the
  // target to the observer.
  [[nodiscard]] AirSpectrum scattered_by(const PathLayers& path, Vec<Body> towards) const;

  // Returns the sunlight that a level path scatters, the mean over azimuths, behind near air if
  // any.
  [[nodiscard]] AirSpectrum scattered_around(const PathLayers& path,
                                             const AbsorberAmounts* near = nullptr) const;
  // Returns the mean radiance of the sunlit sky over the hemisphere, weighted with the sine of the
  // elevation.
  [[nodiscard]] AirSpectrum sky_on_level() const;

  // Returns sunlight in one direction, between two rings (the second has the weight f), not
  // averaged.
  [[nodiscard]] AirSpectrum sky_towards(Vec<Body> direction, std::size_t ring, double f) const;
  [[nodiscard]] AirSpectrum glint_towards(Vec<Body> direction, std::size_t ring, double f) const;
  // Returns the sunlight that the air in front of the surface scatters in one direction: radiance
  // at the target from a ring of ThermalSurroundings::lower, not averaged.  [W m^-2 sr^-1 um^-1]
  [[nodiscard]] AirSpectrum lower_air_towards(Vec<Body> direction, std::size_t ring) const;
  // Returns the sky's sunlight that the surface of a ring of ThermalSurroundings::lower reflects in
  // one direction, cubic between the azimuths of the nodes, and its error; both on
  // NodeWavelengths::used.  [W m^-2 sr^-1 um^-1]
  struct OnSurface {
    std::vector<double> radiance, error;
  };
  [[nodiscard]] OnSurface surface_towards(Vec<Body> direction, std::size_t ring) const;
  [[nodiscard]] double glint_model_relative(Vec<Body> direction) const;
  // Returns one sigma of an incompletely known cloud, relative: of the beam, as a mean over the
  // bands, and of the light that air and cloud scatter, which increases that of aerosol.
  [[nodiscard]] double beam_cloud_relative() const;
  [[nodiscard]] const AirSpectrum& scattered_model_relative() const { return scattered_relative_; }
  // Returns that error without what is not known of a cloud.
  [[nodiscard]] const AirSpectrum& air_model_relative() const { return air_relative_; }
  // Returns sunlight of one ring of ThermalSurroundings::limb(): radiance at the target, not
  // averaged, and its ratio behind near air.
  [[nodiscard]] AirSpectrum limb_towards(Vec<Body> direction, std::size_t ring) const;
  [[nodiscard]] AirSpectrum limb_ratio(std::size_t ring, const AbsorberAmounts& near) const;

 private:
  // Returns the sunlight scattered by a path of the sky, behind near air if any, with the forward
  // peak of a cloud.
  [[nodiscard]] ScatteredSun scattered_in_sky(const PathLayers& path,
                                              const AbsorberAmounts* near = nullptr) const;
  [[nodiscard]] const CloudSunlight* cloud() const { return cloud_ ? &*cloud_ : nullptr; }
  [[nodiscard]] const HazeSunlight* haze() const { return haze_ ? &*haze_ : nullptr; }
  [[nodiscard]] const ScatteredSun& sky_source(std::size_t ring) const;
  [[nodiscard]] const ScatteredSun& limb_source(std::size_t ring) const;
  [[nodiscard]] ScatteredSun scattered_below(std::size_t ring) const;
  [[nodiscard]] const ScatteredSun& lower_source(std::size_t ring) const;
  // Returns the part of the sky's sunlight, whose lines it carries, that the air in front of a ring
  // of the surface lets pass; in twilight of light without lines.
  [[nodiscard]] AirSpectrum passed(std::size_t ring) const;
  // Transmittance from the sun to the surface and back to the target.
  [[nodiscard]] const AirSpectrum& far(std::size_t ring) const;
  // Returns the mean phase function of a direction.
  //   up  1 above the horizon, -1 below
  [[nodiscard]] PhaseMean phase(const std::vector<double>& sine, std::size_t ring, double up,
                                std::uint32_t azimuth) const;
  [[nodiscard]] double zenith_deg() const;
  struct Sky {
    std::vector<AirSpectrum> node;
    double interpolation = 0;
    AirSpectrum mean, model_error;
    std::vector<double> node_error;
  };
  struct Lower {
    std::vector<AirSpectrum> air, surface;  // [azimuth]
  };
  [[nodiscard]] Around make_around() const;
  [[nodiscard]] Sky make_sky() const;
  [[nodiscard]] std::vector<double> lower_node_error(const std::vector<Lower>& lower) const;
  // Returns the sunlight that a ring of the lower hemisphere scatters and reflects.
  //   sky  [node][wanted band]
  [[nodiscard]] Lower make_lower(std::size_t ring, const BandRows<double>& sky) const;
  // Returns the BRDF of a grey, diffuse surface times the cosine of the sun's zenith angle; 0 for
  // other surfaces and for a sun below the horizon. [1/sr]
  [[nodiscard]] double diffuse_per_sr() const;
  // Sets both kinds of interpolation error.
  void find_errors(Sky& sky) const;
  void find_node_errors(Sky& sky, std::span<const std::size_t> bands) const;

  const ThermalSurroundings& weather_;
  Vec<Body> direction_;
  double height_m_;
  std::uint32_t azimuths_;
  const SurfaceBoundary& surface_;
  const NodeWavelengths& wavelengths_;
  const BandChoice& bands_;
  bool only_fog_;
  // Amounts for scattered light, and with a cloud other ones for the beam.
  std::optional<SunAmounts> sun_, beam_;
  std::optional<CloudSunlight> cloud_;
  std::optional<HazeSunlight> haze_;
  AirSpectrum scattered_relative_;             // scattered_model_relative()
  AirSpectrum air_relative_;                   // air_model_relative()
  AirSpectrum whole_;                          // `outside` of the whole disk
  AirSpectrum near_;                           // transmittance from the sun to the target
  std::deque<Lazy<ScatteredSun>> sky_source_;  // [ring]
  std::deque<Lazy<ScatteredSun>> limb_source_;
  std::deque<Lazy<ScatteredSun>> lower_source_;  // [ring below]
  std::deque<Lazy<AirSpectrum>> far_;            // [ring below]
  Lazy<Around> around_;
};

}  // namespace irsig
