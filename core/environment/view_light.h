#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "core/effects/effect_set.h"
#include "core/environment/fit/ring_ratios.h"
#include "core/environment/line_horizon.h"
#include "core/environment/sensor_path.h"
#include "core/environment/sun_light.h"
#include "core/environment/thermal_surroundings.h"

namespace irsig {

// Paths from a line's sensor beside the one to the target.
struct FurtherPaths {
  std::vector<SensorPath> end;   // [SensorLine::end]
  std::vector<SensorPath> land;  // [SensorLine::land_range_m]
};

// One weather seen along one line. Parts that all conditions share are computed when first asked
// for. For one thread only. Private to core/environment.
class ViewLight {
 public:
  // All arguments outlive the object.
  ViewLight(const SensorPath& leg, const ThermalSurroundings& light, const SensorLine& line,
            const LineHorizon& horizon, const NodeWavelengths& wavelengths,
            const FurtherPaths& further);
  ViewLight(const ViewLight&) = delete;
  ViewLight& operator=(const ViewLight&) = delete;

  // Computes what a view sees under a sun.
  //   sun    null: none, or no effect uses it
  //   nodes  with those azimuths that `sun` has if its scattered light is used
  [[nodiscard]] ViewEnvironment seen_under(const SunLight* sun, const EffectSet& effects,
                                           std::uint32_t condition, const DirectionNodes& nodes);

 private:
  struct Solar;  // what the sun adds, behind near air

  // Apparent thermal radiance of a ring.
  [[nodiscard]] const AirSpectrum& sky(std::size_t ring);
  [[nodiscard]] const AirSpectrum& lower(std::size_t ring);
  [[nodiscard]] AirSpectrum seen_lower(std::size_t ring);
  // The air in front of a lower ring's surface, behind the line's.
  [[nodiscard]] const PathLayers::Behind& behind(std::size_t ring);
  // Light of all rings in the sweep's bands: sky, then lower. At the target, and at the sensor with
  // the air's lines joined at all exact rings or at three.
  [[nodiscard]] const std::shared_ptr<const IncidentRadiance::Thermal>& rings();
  using Apparent = std::shared_ptr<const BandRows<double>>;
  [[nodiscard]] const Apparent& rings_apparent(bool joined_lines);
  // Returns the error bound of joining lines at three rings, for the light of one side, with the
  // ratios in front of it.
  [[nodiscard]] double joined_lines_bound(RingRatios& ratio, double share,
                                          const std::vector<const AirSpectrum*>& light) const;
  [[nodiscard]] double joined_lines_bound(Solar* solar);

  void add_around(ViewEnvironment& out, const SunLight* sun, Solar* solar, bool joined_lines,
                  const DirectionNodes& nodes);
  // Radiance behind the target in one direction, at the sensor.
  struct Behind {
    AirSpectrum thermal, light, model_error;
    AirSpectrum interpolation;  // error of light between azimuths
  };
  [[nodiscard]] Behind behind_at(const BehindSight& sight, const SunLight* sun, Solar* solar);
  [[nodiscard]] Behind sky_at(const BehindSight& sight, const SunLight* sun, Solar* solar);
  [[nodiscard]] Behind lower_at(const BehindSight& sight, const SunLight* sun, Solar* solar);
  // Radiance of the sky from the horizon up: rings of the limb, then of the sky.
  [[nodiscard]] const AirSpectrum& sky_from_horizon(std::size_t ring);
  void add_ends(ViewEnvironment& out, const AirSpectrum& scattered, const SunLight* sun);
  void add_behind(ViewEnvironment& out, const SunLight* sun, Solar* solar);
  // Adds the light of land.
  //   sun     whose light the target sees on land; null: none
  //   behind  whose light the sensor sees on land behind the target; null: none
  //   path    sunlight that the air between target and sensor scatters
  void add_land(ViewEnvironment& out, const SunLight* sun, const SunLight* behind,
                const AirSpectrum& path) const;

  const SensorPath& leg_;
  const ThermalSurroundings& light_;
  const SensorLine& line_;
  const LineHorizon& horizon_;
  const NodeWavelengths& wavelengths_;
  const FurtherPaths& further_;
  AirSpectrum path_radiance_;
  ModelError error_;
  RingRatios sky_ratio_, mirrored_ratio_;  // of the sky, and of what the surface mirrors of it
  RingRatios lower_ratio_;                 // of all light from below the horizon
  std::vector<std::optional<AirSpectrum>> sky_, lower_, limb_;
  std::vector<std::optional<AirSpectrum>> sky_error_;      // from the horizon up
  std::vector<std::optional<PathLayers::Behind>> behind_;  // [lower ring]
  std::shared_ptr<const AbsorberAmounts> air_;
  std::shared_ptr<const IncidentRadiance::Shapes> shapes_;
  std::shared_ptr<const IncidentRadiance::Thermal> rings_;
  std::array<Apparent, 2> rings_apparent_;
};

}  // namespace irsig
