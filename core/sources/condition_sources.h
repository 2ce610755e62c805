#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/check.h"
#include "core/effects/effect_set.h"
#include "core/environment/environment.h"
#include "core/sources/condition.h"
#include "core/sources/source_layout.h"
#include "core/sources/source_weights.h"
#include "core/spectral/spectral_axis.h"

namespace irsig {

// A sun, or a light like it, that shines under a condition.
struct LitSun {
  std::uint32_t index;  // of SourceGeometry::sun
  bool direct;          // false: reflected by the target only after the sea
  // Normal to its beam, at the target and what of it is left at the sensor. [W/(m2 um)]
  std::vector<double> irradiance, apparent;
};

// Places of weights: by emitter, as paths leave them, and by light. The two layouts differ where
// emitters have temperatures of their own: in the second the emitters are replaced by the parts
// (each at its stated temperature), followed by blackbodies. Light on land is that of one sun.
struct LightLayout {
  SourceLayout paths, light;
  BlackbodyNodes nodes;  // none: both layouts are the same
};

// The light of every source under one condition, on the sweep's nodes. What the effects leave out
// is dark. For one thread: spectra of land are made when they are first asked for.
class ConditionSources {
 public:
  using Spectrum = std::vector<double>;

  //   environment      outlives this
  //   land_emissivity  [land material][node]
  ConditionSources(const ConditionSpec& condition, const ViewEnvironment& environment,
                   const SourceGeometry& geometry, const LightLayout& layout,
                   std::vector<LitSun> suns, const std::vector<double>& node_um,
                   const EffectSet& effects,
                   std::span<const std::vector<double>> land_emissivity = {});
  ConditionSources(ConditionSources&&) = default;
  ConditionSources(const ConditionSources&) = delete;  // sources point to the spectra

  // Returns the radiance of a source that is not around the target (for the sun: the irradiance),
  // at the target, and the part of it that arrives at the sensor. The background behind the target
  // is no source and has the second alone. [W/(m2 sr um)], [W/(m2 um)]
  [[nodiscard]] std::span<const double> radiance(SourceId id) const {
    return {made(id).radiance, none_.size()};
  }
  [[nodiscard]] std::span<const double> apparent(SourceId id) const {
    return {made(id).apparent, none_.size()};
  }
  // Radiance of the direction nodes, in the layout's order.
  [[nodiscard]] const IncidentRadiance& around() const { return around_; }

  [[nodiscard]] const SourceLayout& layout() const { return layout_.light; }
  // Returns true if emitters have temperatures of their own, whose light is that of blackbodies.
  [[nodiscard]] bool by_element() const { return layout_.nodes.count() > 0; }
  // Returns true if lit() must convert weights of paths before they are multiplied with light.
  [[nodiscard]] bool converts() const {
    return by_element() || layout_.paths.count() != layout_.light.count();
  }
  // Returns the light of a source that paths end on, other than an emitter; nullopt: land that
  // another condition's sun shines on.
  [[nodiscard]] std::optional<SourceId> light_of_path(SourceId of_paths) const;
  [[nodiscard]] SourceWeights lit(const SourceWeights& of_paths) const;
  // Composition of an emitter that paths end on: lights from SourceLayout::seen(first) on.
  struct EmitterShare {
    std::uint32_t first = 0, count = 1;
    std::array<double, 4> weight{1};
  };
  [[nodiscard]] EmitterShare fraction_of(std::uint32_t emitter) const;
  // Returns an emitter that paths have met and whose temperature is not known, if there is one.
  [[nodiscard]] std::optional<std::uint32_t> unknown_emitter(const SourceWeights& of_paths,
                                                             std::size_t parts) const;
  // Returns, for sums over parts of one replicate's weights, the additional emission if every
  // temperature were higher by its error. B is convex in T, so that lower temperatures change the
  // emission less. [source of layout(), emitters alone]
  [[nodiscard]] SummedWeights temperature_errors(const SourceWeights& of_paths,
                                                 std::size_t parts) const;
  [[nodiscard]] bool has_temperature_errors() const { return has_temperature_errors_; }
  // Returns the additional radiance of land, a source of layout(), if its temperature were higher
  // by its error: at the target, and as much of it as arrives at the sensor. [W/(m2 sr)]
  struct LandError {
    double source = 0, apparent = 0;
  };
  [[nodiscard]] LandError land_error_w_m2_sr(SourceId land, const BandOnAxis& band) const;
  // Returns the radiance that a sensor sees of land behind the target, a source of layout(), by
  // what it comes from. Without air: what the land emits, before the air in front of it. [W/(m2
  // sr)]
  struct LandParts {
    double without_air = 0, emitted = 0, sky = 0, sun = 0;
  };
  [[nodiscard]] LandParts land_parts_w_m2_sr(SourceId behind, const BandOnAxis& band) const;
  [[nodiscard]] bool has_land_errors() const { return !land_.error.empty(); }
  // Returns the largest relative error of a radiance between blackbodies.
  [[nodiscard]] double emission_error(double shortest_um) const {
    return by_element() ? layout_.nodes.relative_error(shortest_um) : 0;
  }
  [[nodiscard]] const ViewEnvironment& environment() const { return *environment_; }
  [[nodiscard]] const std::vector<LitSun>& suns() const { return sun_; }
  // Returns the sources of each cause.
  [[nodiscard]] std::array<std::vector<SourceRange>, kCauses> causes() const;

  // Returns the largest in-band radiance of a part. [W/(m2 sr)]
  [[nodiscard]] double part_w_m2_sr(std::uint32_t part, const BandOnAxis& band) const;
  // Returns the largest in-band radiance of the sky and of the surface below the horizon. [W/(m2
  // sr)]
  [[nodiscard]] double brightest_around_w_m2_sr(const BandOnAxis& band) const;
  // Returns the largest in-band radiance of anything but the sun. [W/(m2 sr)]
  [[nodiscard]] double brightest_thermal_w_m2_sr(const BandOnAxis& band) const;
  // Returns the largest in-band radiance of any source, a sunlit white surface included: the most
  // that a lost path can have carried. [W/(m2 sr)]
  [[nodiscard]] double brightest_w_m2_sr(const BandOnAxis& band) const {
    return brightest_w_m2_sr(band, brightest_thermal_w_m2_sr(band));
  }
  [[nodiscard]] double brightest_w_m2_sr(const BandOnAxis& band, double brightest_thermal) const;
  // Returns the coldest and the hottest temperature of emitting surfaces, at least 1 K each. [K]
  [[nodiscard]] double coldest_k() const { return coldest_k_; }
  [[nodiscard]] double hottest_k() const { return hottest_k_; }

 private:
  struct Light {  // spectra of this condition or of its environment
    const double *radiance, *apparent;
    bool is_land = false;  // of which both may have to be made
  };
  // Returns the light of a source that is not around the target.
  [[nodiscard]] const Light& made(SourceId id) const {
    Light& light = light_[index_of(id)];
    if (light.apparent == nullptr && light.is_land) make_land(id, light);
    IRSIG_CHECK(light.apparent != nullptr);  // both are, or none is
    return light;
  }
  void make_land(SourceId id, Light& light) const;
  // Returns what land of one index, without its sunlight, sends through air.
  [[nodiscard]] Spectrum land_through(std::uint32_t index, const LandAir& air) const;
  [[nodiscard]] Light light_of(SourceId id, const Emitters& emitters,
                               const EffectSet& effects) const;

  LightLayout layout_;
  std::shared_ptr<const EmitterTemperatures> emitter_;  // null: each part has one
  bool has_temperature_errors_ = false, has_unknown_temperatures_ = false;
  std::vector<LitSun> sun_;
  double coldest_k_, hottest_k_;
  std::size_t parts_;
  // Index of the blackbody, one for each temperature, of each part and then of each node.
  std::vector<std::uint32_t> blackbody_;
  std::vector<Spectrum> emitted_, emitted_apparent_;
  std::vector<std::vector<Spectrum>> glint_, glint_apparent_;  // [lit sun][kGlintCosines]
  // Land as SourceLayout numbers it: kinds, then materials that face land as further kinds.
  struct LandSpectra {
    std::vector<std::uint32_t> material;  // [kind]
    std::uint32_t open = 0;               // kinds that face the sky; others have emissivity 1
    std::vector<Spectrum> planck;         // [kind] of its temperature
    // [kind] Emission by which land may be wrong. Empty: temperatures are stated.
    std::vector<Spectrum> error;
    std::vector<Spectrum> emissivity;                     // [material]
    std::vector<Spectrum> sun, sun_apparent, behind_sun;  // [material x ranges + node of the range]
    // Those made so far, at any place: spectra stay where they are.
    mutable std::deque<Spectrum> made;
  };
  LandSpectra land_;
  Spectrum none_;
  IncidentRadiance around_;
  mutable std::vector<Light> light_;  // [source]
  const ViewEnvironment* environment_;
};

// Returns the integral of a spectrum on the sweep's nodes over a band.
[[nodiscard]] double in_band(std::span<const double> spectrum, const BandOnAxis& band);

}  // namespace irsig
