#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// Random scenes for `irsig selftest --search`, each a function of its seed. They stay within the
// grammar of sweep files, and consist of elements that have broken error bars before
// (docs/evidence/stability.md).

// The main subject of a scene.
enum class SceneFamily {
  kBodies,        // up to 12 bodies of any kind
  kGrazingGloss,  // a glossy plate seen at 75 to 89.5 deg, often towards the sun
  kHole,          // a hot patch that is seen, or shines, only through a hole
  kSmallMirror,   // a near-mirror that sends the sun to the sensor, on a large body
  kMirrorPair,    // the same by way of two mirrors
  kNotch,         // emissivities narrower than the stored wavelengths
  kHorizon,       // target and sensor near the sea's horizon
  kCavity,        // several reflections between grey walls
  kNeedles,       // bodies 1 : 100 to 1 : 4000
  kWeather,       // the embedded atmosphere; smooth surfaces under its sky
  kLand,          // the same above land
};
inline constexpr int kSceneFamilies = 11;
[[nodiscard]] const char* name_of(SceneFamily family);

// Parameters of the scenes.
struct SceneGrammar {
  double best_relative_error = 0.01, worst_relative_error = 0.1;
  std::uint64_t max_samples_per_replicate = 16384;
};

struct RandomMaterial {
  std::string name;
  std::string toml;              // its keys but for the name
  double mean_emissivity = 0.8;  // of the grey paint that a smaller scene has in its place
};

// A closed body or a two-sided plate, in the axes of its OBJ file: x forward, y port, z up. [m]
struct RandomBody {
  enum class Kind { kBox, kSphere, kPlate, kCup } kind = Kind::kBox;
  std::array<double, 3> centre_m{}, size_m{1, 1, 1};
  // Columns: the images of the body's own axes.
  std::array<std::array<double, 3>, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  double aperture =
      0.5;           // cup: side of the hole / side of the cup; its walls are a twentieth thick
  double patch = 0;  // cup: side of a part of its own in the middle of the floor / floor's side
  std::size_t material = 0, patch_material = 0;
  double temperature_k = 290, patch_temperature_k = 290;
  bool split = false;  // two parts instead of one: an invariance
};

// A layer of cloud, as [[season.cloud]] has it; its type is its phase.
struct RandomCloud {
  double cover = 0;  // 0: no cloud
  bool ice = false;
  double base_m = 0, thickness_m = 0, water_path_g_m2 = 0, effective_radius_um = 0;
};

// Two materials on waves of land, which pass through z = 0 below the reference point. They rise
// less than half as high as target and sensor. In the frame of the land: x east, y north.
struct RandomLand {
  double amplitude_m = 0;  // of each wave; 0: no land
  std::array<double, 2> wave_m{}, phase{};
  double turn_rad = 0;  // of the first wave's crests
  double patch_m = 0;   // wavelength of the fractions
  std::array<double, 2> temperature_k{};
  double ground_temperature_k = 0;  // beyond the map
};

struct RandomBand {
  double lambda_min_um, lambda_max_um, step_um;
};

struct RandomScene {
  std::uint64_t seed = 0;
  SceneFamily family = SceneFamily::kBodies;
  std::vector<RandomMaterial> material;
  std::vector<RandomBody> body;
  std::vector<RandomBand> band;
  bool sea = false, sun = false, homogeneous_air = false, path_emission = false;
  double sky_temperature_k = 250, sea_temperature_k = 288, sea_emissivity = 0.95;
  double air_temperature_k = 285, absorption_m2_kg = 1e-5;
  double lower_radiance_w_m2_sr_um = 0;
  // The embedded atmosphere over a rough sea in place of air and sky; judged by invariances alone.
  bool atmosphere = false;
  double visibility_m = 23000, wind_speed_m_s = 5;
  RandomCloud cloud;  // drawn separately: without it the scene of a seed is the same
  RandomLand land;    // drawn separately, in place of the sea
  std::string time = "12:00Z";
  double heading_deg = 0;
  double azimuth_deg = 0, elevation_deg = 0, range_m = 1000;
  double relative_error = 0.05;
  std::uint64_t max_samples_per_replicate = 16384;
  std::uint64_t sampler_seed = 1;
  bool all_effects = false;
  int max_reflections = -1;     // below 0: the default
  int subdivisions = 0;         // each triangle is cut into four, so often
  std::string prefix = "body";  // of the parts' names
  bool mirrored = false;        // left for right, the sun and the sensor too
};

[[nodiscard]] RandomScene random_scene(std::uint64_t seed, const SceneGrammar& grammar = {});

// Returns the text of the sweep file, which names `model_name`, or of that OBJ file. Both are
// functions of the scene alone.
[[nodiscard]] std::string sweep_toml(const RandomScene& scene, const std::string& model_name);
[[nodiscard]] std::string model_obj(const RandomScene& scene);

// Returns the names or contents of the maps that the sweep file of a scene with land names:
// heights, and fractions of the scene's first material.
[[nodiscard]] std::string heights_name(const std::string& model_name);
[[nodiscard]] std::string fractions_name(const std::string& model_name);
[[nodiscard]] std::string heights_asc(const RandomScene& scene);
[[nodiscard]] std::string fractions_asc(const RandomScene& scene);

// The direction of the scene's sun, as azimuth clockwise from north and elevation. [deg]
struct SceneSun {
  double azimuth_deg, elevation_deg;
};
[[nodiscard]] SceneSun sun_of(const std::string& time);

}  // namespace irsig
