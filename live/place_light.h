#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/signature/view/shading.h"
#include "live/live_gas.h"
#include "live/live_sweep.h"
#include "live/reflected_sky.h"

namespace irsig {

// Effects that the live view can switch.
struct LiveEffects {
  bool sun = true;    // all sunlight
  bool sky = true;    // light of sky and surface that the target reflects
  bool parts = true;  // light of its own parts that the target reflects
  bool operator==(const LiveEffects&) const = default;
};

// Returns the effects of a job with these live effects: `otherwise`, if all are on; else those by
// name.
[[nodiscard]] EffectChoice live_effects(const LiveEffects& on, EffectChoice otherwise);
// Returns the names of the effects that are on, for [effects] of a sweep file.
[[nodiscard]] std::vector<std::string> names_of(const LiveEffects& on);

// One condition and band, with the effects that are on.
struct LiveChoice {
  std::uint32_t condition = 0, band = 0;
  LiveEffects effects;
  bool operator==(const LiveChoice&) const = default;
};

// Nodes of the cosine of the angle at which a surface is seen, linear in its square root.
inline constexpr std::uint32_t kEmissionCosines = 17;
// Returns a row of kEmissionCosines numbers at a cosine.
[[nodiscard]] inline float at_cosine(const float* row, float cosine) {
  const float position = std::sqrt(cosine) * (kEmissionCosines - 1);
  const auto low = std::min(static_cast<std::uint32_t>(position), kEmissionCosines - 2);
  return row[low] + (position - static_cast<float>(low)) * (row[low + 1] - row[low]);
}
// Directions of a background on each side of the horizon. The distance from the horizon grows with
// the square of the index: the path through the air changes fastest there.
inline constexpr std::uint32_t kSideNodes = 20;

// In-band radiances of everything that a sensor at one place can see, with the air between. The
// tables are linear between their entries, so that the tables of two places may be mixed number by
// number. [W/(m2 sr)]. Air is that of the line of sight to the target, except for the background
// behind it.
struct PlaceLight {
  std::vector<float> emitted;  // [material][light][kEmissionCosines], of ConditionSources::emitted
  std::vector<float> blackbody;  // [light] as bright as a blackbody of its temperature
  std::vector<float> reflected;  // [material][ReflectedSky::kEntries]
  std::vector<float> sun;        // [column] irradiance of the sun at the target; empty: none [W/m2]
  // [material][kEmissionCosines] irradiance of the sun times the material's reflectance [W/m2]
  std::vector<float> sun_reflected;
  float sun_total = 0;            // irradiance of the sun [W/m2]
  std::vector<float> background;  // [2 x kSideNodes] above, then below the horizon, from it on
  std::vector<float> land;        // [kind, then material][range]
  std::vector<float> land_sun;    // [material][range] per unit cosine of incidence
  std::vector<float> land_error;  // [kind, then material][range] of temperatures
  std::vector<float> gas;         // LiveGas::weights; empty: no gas, or none that a table has
  float path = 0;                 // of the air between the sensor and the target

  // Adds `weight` times another place's numbers; takes the other's sizes if this one is empty.
  void add(float weight, const PlaceLight& other);
};

// Sizes and light that all places of a choice share.
struct LightFrame {
  std::uint32_t materials = 0, lights = 0, columns = 1;
  std::size_t first_column = 0;
  std::uint32_t kinds = 0, land_materials = 0;  // of land; 0: none
  std::vector<double> land_range_m;
  Vec<Body> sun;            // towards it
  bool sun_shines = false;  // on the target
  // [facet] OwnParts::sunlight; empty: none reaches a facet by way of others
  std::vector<float> own_sun;
  // [emitter] Lights of which an emitter consists: ConditionSources::fraction_of.
  std::vector<ConditionSources::EmitterShare> emitter;
  std::vector<float> kelvin;  // [emitter]
};

// Tables of one choice at any place. Immutable and thread-safe.
class PlaceLights {
 public:
  // Makes the lights of a sweep. Errors: those of Environment::view().
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<const PlaceLights>> make(
      std::shared_ptr<const LiveSweep> sweep, std::shared_ptr<const ReflectedSky> reflected,
      const LiveChoice& choice, const Viewpoint& viewpoint);

  [[nodiscard]] const LightFrame& frame() const { return frame_; }
  // Returns the hot gas of the choice; null: it has none, or its light cannot be tabulated.
  [[nodiscard]] const LiveGas* gas() const { return gas_.get(); }
  [[nodiscard]] const LiveChoice& choice() const { return choice_; }
  // Returns true if light depends on the azimuth of the sensor, or on its place at all.
  [[nodiscard]] bool depends_on_azimuth() const;
  [[nodiscard]] bool depends_on_place() const {
    return sweep_->environment() != nullptr || has_air_;
  }

  // Computes the light of a sensor at a place. INVALID_ARGUMENT: a place below the surface, or one
  // from which the Earth hides the target.
  [[nodiscard]] absl::StatusOr<PlaceLight> at(const Viewpoint& viewpoint) const;
  // Returns the elevation at which a sensor at this range is 2 m above the surface, and no less
  // than -90 deg; without a surface -90.
  [[nodiscard]] double least_elevation_deg(double range_m) const;
  // Returns Land::bend_of for a sensor.
  [[nodiscard]] double land_bend_per_m(const Viewpoint& viewpoint) const;
  // Returns the z of a sensor's horizon (Environment::Horizon::z).
  [[nodiscard]] absl::StatusOr<double> horizon_z(const Viewpoint& viewpoint) const;

 private:
  PlaceLights() = default;
  struct Made;
  [[nodiscard]] absl::StatusOr<Made> made(const Viewpoint& viewpoint) const;
  [[nodiscard]] std::size_t background_node(const Viewpoint& viewpoint,
                                            const ViewEnvironments& environments) const;
  void fill_land(const ViewSources& sources, PlaceLight& out) const;
  [[nodiscard]] std::vector<double> around_rings(const ViewSources& sources,
                                                 const SourceTable& table) const;

  std::shared_ptr<const LiveSweep> sweep_;
  std::shared_ptr<const ReflectedSky> reflected_;
  LiveChoice choice_;
  LightFrame frame_;
  std::unique_ptr<const LiveGas> gas_;
  bool has_air_ = false;
  double above_surface_m_ = INFINITY;  // of the target's reference point
};

}  // namespace irsig
