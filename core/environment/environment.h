#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/atmosphere/atmosphere.h"
#include "core/atmosphere/imported_path.h"
#include "core/effects/effect_set.h"
#include "core/environment/air.h"
#include "core/environment/background_directions.h"
#include "core/environment/direction_nodes.h"
#include "core/environment/incident_radiance.h"
#include "core/environment/sea_surface.h"
#include "core/geo/viewpoint.h"

namespace irsig {

// The surface below the horizon.
struct SurfaceBoundary {
  enum class Kind {
    kRoughSea,  // facets with Cox and Munk's slopes for the wind: emission, reflected sky
    kFlatSea,   // a mirror of water; the sun in it is left out
    kGreySea,   // emissivity, diffuse
    kGround     // emissivity, diffuse; the target stands on it as on the sea
  } kind = Kind::kRoughSea;
  double temperature_k = 0;
  double emissivity = 1;      // kGreySea, kGround
  double wind_speed_m_s = 0;  // kRoughSea
};

// Lowest height above sea or ground of the point that stands for a target in the air. [m]
inline constexpr double kLowestAirPointM = 1;

// One season's weather: the part of a condition that does not depend on the sun.
struct WeatherSpec {
  AtmosphereSpec air;  // its profile already bent to the surface
  bool refraction = true;
  SurfaceBoundary lower;
  // Somebody else's transmittance and path radiance instead of the embedded model's; null: none.
  std::shared_ptr<const ImportedPaths> imported;
  // Height of the target's reference point above sea or ground; it then stands for the target, from
  // kLowestAirPointM on. 0: the target stands on the surface (Environment::make). [m]
  double above_surface_m = 0;
  // [0, 1] Of the weather, which the sky here does not show: it is clear. The models' errors of sky
  // and sun have what clouds would change.
  double cloud_cover = 0;
};

// The air, sky and sea of one condition of a sweep.
struct ConditionEnvironment {
  std::uint32_t weather = 0;  // index
  bool sun = false;           // whether it is to shine; what of it has set gives nothing
  Vec<Body> sun_direction;    // unit vector, airless
  double sun_distance_au = 1;
};

// Light and air of one view under one condition, on the wavelengths of the sweep (index i).
// Radiances in W/(m2 sr um), irradiances in W/(m2 um). "Apparent" is the part that arrives at the
// sensor, the air's lines joined by summed absorber amounts (core/atmosphere/absorber_amounts.h),
// without the path's own radiance. Inside one of the air's bands radiances follow Planck's function
// at the target's air temperature, and sunlight the sun's spectrum.
//
// Below the horizon: the surface's emission and its reflection of the sky, seen through the air in
// front of it; light that a rough sea mirrors from below the horizon has met the sea before. The
// sun that a rough sea mirrors is in background_apparent only: for the target's reflections it is a
// light of its own (sea_glint.h). The sun that a grey surface reflects is in the nodes.
//
// Accuracy (tests/physics/environment_nodes_test.cpp, mid-latitude summer, maritime aerosol of 23
// km): night sky from the nodes 1.1e-3 in the mean over 1000 directions; sunlit sky at 3.7 um as
// planes see it 1e-3, as lobes 30 deg wide see it 1 %; night sky behind air within 0.5 %; sunlit
// sky in one direction 4 %, of which half is the error of the reference sums. Limits: one zenith
// angle of the sun for all of a path; sunlight is scattered once.
struct ViewEnvironment {
  using Spectrum = std::vector<double>;
  Spectrum transmittance;  // band means: of what surfaces emit
  Spectrum path_radiance;  // emitted and scattered between target and sensor
  // Absorbers between target and sensor; null: the air is imported, or there is no embedded
  // atmosphere.
  std::shared_ptr<const AbsorberAmounts> air;
  std::vector<AirPath> end;                        // [Line::end] the same of the target's ends
  std::vector<IncidentRadiance::AirChange> end_change;  // [Line::end] by how much they differ
  Spectrum sun, sun_apparent;                      // normal to the beam, at the target; 0: no sun
  IncidentRadiance around;                         // sky, then lower
  std::vector<Spectrum> background_apparent;       // [node of Line::behind]
  // Errors of background_apparent: the largest deviation from straight lines to the neighbouring
  // nodes found at three places between (within a factor of 2 of the largest error,
  // tests/physics/horizon_test.cpp), and one sigma of the models. Empty: none.
  std::vector<Spectrum> background_interpolation, background_model_error;

  // IncidentRadiance::interpolation is the most by which straight lines between a node and those
  // beside it were found to err, half way between rings, and of sunlight at 25 places of each cell.
  // Summed with the weights of paths it bounds what narrow lobes see. Relative interpolation error
  // of the nodes' radiance between them: mean over the side's solid angle of |linear - direct| /
  // mean radiance, in the worst quarter of a micrometre; 1.5e-3 and 8e-4. Of the sunlit sky: and
  // mean over lobes of cos^20 (30 deg wide) of the aureole's; to 5e-3.
  double sky_interpolation = 0, lower_interpolation = 0;
  // Bound for leaving out EffectSet::joined_lines, relative to the reflected light of sky and
  // surface at the target: the largest difference of any mean over directions of the apparent
  // nodes, in the worst quarter of a micrometre. 0 if the lines are joined.
  double joined_lines_bound = 0;
  // One sigma of the models, without the numerics.
  Spectrum model_error_transmittance, model_error_path_radiance;
  double sky_model_relative = 0, lower_model_relative = 0, sun_model_relative = 0;
};

// The most that light can be, known before any sky is computed. On the sweep's wavelengths.
struct LightBounds {
  using Spectrum = std::vector<double>;
  Spectrum transmittance, path_radiance;  // of the line, its own emission only: not bounds
  Spectrum thermal;                       // radiance of sky and surface
  Spectrum sun;                           // irradiance, normal to the beam
  // Radiance in any direction, and radiance integrated over all directions: an upper limit of the
  // irradiance of any facet.
  Spectrum diffuse_sun, diffuse_sun_w_m2_um;
  Spectrum mirrored_sun, mirrored_sun_w_m2_um;  // by a rough sea towards the target
  Spectrum path_sun;                            // at the sensor
  Spectrum background_sun;                      // at the sensor, in any direction of Line::behind
};

// The embedded atmosphere with its sky, sun and sea, for all conditions of a sweep. Immutable but
// for a cache of what does not depend on the view; any number of threads may ask. What is returned
// for a line of sight depends on that line and the condition alone.
class Environment {
 public:
  // target_height_m: of the point that stands for the target, above the sea or ground (> 0), where
  // weathers have no above_surface_m. INVALID_ARGUMENT: only some of them have one.
  // node_um: the wavelengths; OUT_OF_RANGE if one lies outside the atmosphere's table.
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

  // The sun of a condition as the target's point sees it: lifted by refraction (if the weather has
  // it), its disk cut by the horizon. Limits: the disk stays round, where refraction flattens it by
  // a fifth at the horizon; below the horizon its centre is lifted as the horizon is.
  struct SunSeen {
    Vec<Body> direction;  // unit vector to the disk's centre
    double horizon_z;     // directions with a larger z have set
    double visible;       // share of the disk that has not; 0: none, or no sun
    Vec<Body> middle;     // of that share; unit vector
  };
  [[nodiscard]] const SunSeen& sun_seen(std::uint32_t condition) const;

  // A line from the target to a sensor.
  struct Line {
    double range_m;
    double elevation_deg;  // of the sensor, at the target, geometric; -90 .. 90
    Vec<Body> direction;   // unit vector towards the sensor
    BackgroundDirections behind;  // where the background is wanted: directions away from the sensor
    // Other places of the target, by what of the air lies in front of them: how far they are from
    // the sensor, and how high above the target's reference point.
    struct End {
      double range_m, height_m;
    };
    std::vector<End> end = {};
  };
  // Returns the line from the point that stands for the target: `viewpoint` has range and elevation
  // at its reference point. The line has no directions behind the target.
  [[nodiscard]] Line line(const Viewpoint& viewpoint) const;

  // End of the sea (or ground) for the sensor of a line, refracted if the weather is.
  struct Horizon {
    // Straight lines from the sensor that fall less than this pass above it: z of their unit vector
    // (BackgroundDirections).
    double z;
    // The Earth hides the same part of the target as a sphere of this radius hides from straight
    // lines that rise to the sensor by `lift_rad` more than the geometric ones.
    double earth_radius_m, lift_rad;
    // Up to this height above the surface it hides what stands where the target does; 0: nothing.
    double hides_m = 0;
  };
  // The mean of all conditions': one set of paths has one geometry.
  [[nodiscard]] Horizon horizon(const Line& line) const;
  [[nodiscard]] Horizon horizon(const Line& line, std::uint32_t condition) const;
  // z of each weather's, in their order.
  [[nodiscard]] std::vector<float> horizons_z(const Line& line) const;

  // around: with the light of sky and surface that a target reflects, which takes most of the time;
  // else ViewEnvironment::around is of two dark nodes.
  // INVALID_ARGUMENT: a sensor below the surface; one from which the Earth hides the target up to
  // the highest of Line::end; a line that the imported paths do not cover. Where the Earth hides
  // the target's point, the air is that in front of the middle of what is in sight above it.
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
    // Returns the light of the line under a condition. The result depends on the line, the
    // condition and the effects alone; effects that are left out are 0. `effects` has as many
    // conditions as the environment. For lines with directions behind the target,
    // EffectSet::joined_lines chooses whether the air's lines are joined at every ring that is
    // computed exactly (8 of a side), or at three of them. The nodes are those of
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
  // INVALID_ARGUMENT as view() has it.
  [[nodiscard]] absl::StatusOr<SightLine> sight_line(const Line& line) const;

  [[nodiscard]] std::size_t conditions() const;
  // Upper limit of the memory that a condition needs while a view is computed, including memory
  // kept between views; from counts, without small allocations.  [bytes]
  [[nodiscard]] double bytes_per_condition() const;

 private:
  struct Parts;
  explicit Environment(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

// Edges of the air's bands between two wavelengths, increasing: where spectra jump. [um]
[[nodiscard]] std::vector<double> air_band_edges_um(double lambda_min_um, double lambda_max_um);

}  // namespace irsig
