#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/effects/effect_set.h"
#include "core/environment/air.h"
#include "core/environment/fit/direction_nodes.h"
#include "core/environment/sea/sea_surface.h"
#include "core/environment/view_environment.h"
#include "core/environment/weather_spec.h"
#include "core/geo/viewpoint.h"

namespace irsig {

// The embedded atmosphere with its sky, sun and sea, for all conditions of a sweep. Immutable but
// for a cache of what does not depend on the view; any number of threads may ask. What is returned
// for a line of sight depends on that line and the condition alone.
class Environment {
 public:
  // Makes the environment of some conditions.
  //   target_height_m  of the point that stands for the target, above the sea or ground (> 0),
  //                    where weathers have no above_surface_m
  //   node_um          the wavelengths
  // INVALID_ARGUMENT: only some weathers have above_surface_m. OUT_OF_RANGE: a wavelength lies
  // outside the atmosphere's table.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<const Environment>> make(
      std::vector<WeatherSpec> weather, std::vector<ConditionEnvironment> condition,
      double target_height_m, std::vector<double> node_um);
  ~Environment();

  // Returns the mean thermal radiance of sky and surface over all directions, which the air around
  // the target's point scatters into a path. [band of the air; 0 where no wavelength lies]
  [[nodiscard]] const AirSpectrum& surroundings_w_m2_sr_um(std::uint32_t weather) const;

  // The directions at which sky and sea are given; one azimuth if no condition has a sun.
  [[nodiscard]] const DirectionNodes& nodes() const;
  // The rings of nodes(), with one azimuth if `with_azimuths` is false.
  [[nodiscard]] const DirectionNodes& nodes(bool with_azimuths) const;

  // Returns true if a condition's weather has a layer of cloud.
  [[nodiscard]] bool cloudy(std::uint32_t condition) const;

  // The surface below the horizon under a condition.
  [[nodiscard]] const SurfaceBoundary& surface(std::uint32_t condition) const;

  using SunSeen = irsig::SunSeen;
  [[nodiscard]] const SunSeen& sun_seen(std::uint32_t condition) const;

  using Line = SensorLine;
  // Returns the line from the point that stands for the target: `viewpoint` has range and elevation
  // at its reference point. The line has no directions behind the target.
  [[nodiscard]] Line line(const Viewpoint& viewpoint) const;

  using Horizon = SeaHorizon;
  // Returns the mean horizon of all conditions, since one set of paths has one geometry.
  [[nodiscard]] Horizon horizon(const Line& line) const;
  [[nodiscard]] Horizon horizon(const Line& line, std::uint32_t condition) const;
  // Returns the z of each weather's horizon, in their order.
  [[nodiscard]] std::vector<float> horizons_z(const Line& line) const;

  // Computes what a line sees under some conditions. Where the Earth hides the target's point, the
  // air is that in front of the middle of the part in sight above it. INVALID_ARGUMENT: a sensor
  // below the surface; one from which the Earth hides the target up to the highest of Line::end; a
  // line that the imported paths do not cover.
  //   around  true: with the light of sky and surface that a target reflects, which takes most of
  //           the time; false: ViewEnvironment::around has two dark nodes
  [[nodiscard]] absl::StatusOr<std::vector<ViewEnvironment>> view(
      const Line& line, std::span<const std::uint32_t> conditions, bool around = true) const;

  // A line of sight, to be asked for bounds first and for light then; what they share is computed
  // once. Not for several threads. The environment outlives it.
  class SightLine {
   public:
    SightLine(SightLine&&) noexcept;
    SightLine& operator=(SightLine&&) noexcept;
    ~SightLine();
    [[nodiscard]] const LightBounds& bounds(std::uint32_t condition);
    // Returns the most that light can change if a condition's cloud is left out. nullopt: the
    // condition has no cloud, or target or line of sight reach it.
    [[nodiscard]] std::optional<CloudBounds> cloud_bounds(std::uint32_t condition);
    // Returns the light of the line under a condition. The result depends on the line, the
    // condition and the effects alone; effects that are left out are 0, and without its cloud a
    // condition has the light of the clear sky, but behind the target what the cloud shows there.
    // `effects` has as many conditions as the environment. For lines with directions behind the
    // target, EffectSet::joined_lines chooses whether the air's lines are joined at every ring that
    // is computed exactly (8 of a side), or at three of them. The nodes are those of
    // nodes(with_azimuths): INVALID_ARGUMENT if a sun is up whose scattered light is to be
    // reflected and the nodes have no azimuths.
    [[nodiscard]] absl::StatusOr<ViewEnvironment> evaluate(std::uint32_t condition,
                                                           const EffectSet& effects,
                                                           bool with_azimuths);

   private:
    friend class Environment;
    struct Parts;
    explicit SightLine(std::unique_ptr<Parts> parts);
    std::unique_ptr<Parts> parts_;
  };
  // Makes a line of sight. INVALID_ARGUMENT as in view().
  [[nodiscard]] absl::StatusOr<SightLine> sight_line(const Line& line) const;

  [[nodiscard]] std::size_t conditions() const;
  // Returns an upper limit of the memory that a condition needs while a view is computed, including
  // memory kept between views; from counts, without small allocations. [bytes]
  [[nodiscard]] double bytes_per_condition() const;

 private:
  struct Parts;
  explicit Environment(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

// Edges of the air's bands between two wavelengths, increasing: where spectra jump. [um]
[[nodiscard]] std::vector<double> air_band_edges_um(double lambda_min_um, double lambda_max_um);

}  // namespace irsig
