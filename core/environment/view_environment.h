#pragma once

#include <memory>
#include <vector>

#include "core/atmosphere/absorber_amounts.h"
#include "core/environment/air.h"
#include "core/environment/background_directions.h"
#include "core/environment/incident_radiance.h"
#include "core/environment/land_air.h"
#include "core/geo/frames.h"

namespace irsig {

// A line from the target to a sensor.
struct SensorLine {
  double range_m;
  double elevation_deg;         // of the sensor, at the target, geometric; -90 .. 90
  Vec<Body> direction;          // unit vector towards the sensor
  BackgroundDirections behind;  // where the background is wanted: directions away from the sensor
  // Other places of the target, by what of the air lies in front of them: how far they are from
  // the sensor, and how high above the target's reference point.
  struct End {
    double range_m, height_m;
  };
  std::vector<End> end = {};
  // True with land around the target; and ranges from the sensor, increasing, at which land
  // behind the target is to be seen.
  bool land = false;
  std::vector<double> land_range_m = {};
};

// The sun of a condition as the target's point sees it: lifted by refraction (if the weather has
// it), its disk cut by the horizon. Limits: the disk stays round, where refraction flattens it by
// a fifth at the horizon; below the horizon its centre is lifted as the horizon is.
struct SunSeen {
  Vec<Body> direction;  // unit vector to the disk's centre
  double horizon_z;     // directions with a larger z have set
  double visible;       // share of the disk that has not; 0: none, or no sun
  Vec<Body> middle;     // of that share, or of what set last; unit vector
  bool lights_air;      // it shines on air that the target sees, in twilight too
};

// End of the sea (or ground) for the sensor of a line, refracted if the weather is.
struct SeaHorizon {
  // Straight lines from the sensor that fall less than this pass above it: z of their unit vector
  // (BackgroundDirections).
  double z;
  // The Earth hides the same part of the target as a sphere of this radius hides from straight
  // lines that rise to the sensor by `lift_rad` more than the geometric ones.
  double earth_radius_m, lift_rad;
  // Up to this height above the surface it hides what stands where the target does; 0: nothing.
  double hides_m = 0;
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
  // atmosphere. Under broken cloud `air` is that of the clear sky, and overcast_air, which has the
  // cloud's particles, counts by overcast_fraction; null: one air for all of the light.
  std::shared_ptr<const AbsorberAmounts> air, overcast_air;
  double overcast_fraction = 0;
  std::vector<AirPath> end;  // [SensorLine::end] the same of the target's ends
  std::vector<IncidentRadiance::AirChange> end_change;  // [SensorLine::end] by how much they differ
  Spectrum sun, sun_apparent;                 // normal to the beam, at the target; 0: no sun
  IncidentRadiance around;                    // sky, then lower
  std::vector<Spectrum> background_apparent;  // [node of SensorLine::behind]
  LandLight land;                             // empty unless SensorLine::land
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
  // Means over the sky that the target reflects: radiance, and one sigma of its models.
  Spectrum sky_mean, sky_model_error;
  // One sigma, relative, of the light that the target reflects from below the horizon and from the
  // sun.
  double lower_model_relative = 0, sun_model_relative = 0;
  // Light and air under one of the two skies of which a broken one is the mean: the overcast one
  // where the cover is below a half, else the clear one. Null: there is one sky. A target has one
  // sky or the other; one sigma of that choice in any sum of light is one_sky_sigma times the
  // difference between its values under one_sky and under the mean. The models' errors above are
  // without it.
  std::shared_ptr<const ViewEnvironment> one_sky;
  double one_sky_sigma = 0;
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
  Spectrum background_sun;  // at the sensor, in any direction of SensorLine::behind
};

// Bounds of the change of light from a sky with a cloud to a clear one, for a target and a line
// of sight below the cloud. On the sweep's wavelengths.
struct CloudBounds {
  LightBounds most;                         // the larger of the bounds under both skies
  LightBounds::Spectrum path_surroundings;  // thermal light that the line scatters to the sensor
  // The larger of the cover and of the standard deviation of the choice between both skies, which
  // is a model error of rows under a broken one.
  double weight = 1;
};

}  // namespace irsig
