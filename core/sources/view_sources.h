#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/sources/condition_sources.h"

namespace irsig {

// Light and air of one view under the conditions of a request, and the directions to which they
// refer.
struct ViewEnvironments {
  DirectionNodes directions;
  BackgroundDirections behind;
  // End of the sea or ground for the sensor; without either, the horizontal.
  std::optional<Environment::Horizon> horizon;
  std::vector<double> land_range_m = {};   // SensorLine::land_range_m
  double land_bend_per_m = 0;              // Land::bend_of
  std::vector<ViewEnvironment> condition;  // of the request; empty where it was not asked for
};

// Inputs from which the sources of a view are made.
struct SourceRequest {
  std::span<const ConditionSpec> condition;  // all
  std::span<const std::uint32_t> wanted;     // those whose light is asked for
  std::size_t parts = 0;
  double surface_z_m = 0;  // of sea or ground, relative to the target's centre
  bool contrast = true;    // whether what stands behind the target is wanted
  // Emitters of the scene; needed where conditions state temperatures of emitters.
  std::shared_ptr<const Emitters> emitters = nullptr;
  // Land around the target, the emissivities of its materials, [material][node], and the target's
  // centre relative to its reference point. Null: none.
  std::shared_ptr<const LandScene> land = nullptr;
  std::span<const std::vector<double>> land_emissivity = {};
  Vec<Body> centre = {};
};

// All light of a view: where it is (what paths can end on), and how bright under each condition.
// Conditions whose suns stand at the same place share them. Move only.
class ViewSources {
 public:
  // environments: with the light of the wanted conditions. `request` is not kept.
  ViewSources(const SourceRequest& request, const EffectSet& effects,
              std::shared_ptr<const ViewEnvironments> environments,
              const std::vector<double>& node_um);

  [[nodiscard]] const SourceGeometry& geometry() const { return geometry_; }
  // Layout of the light: paths end on emitters (PathTracer::layout), light comes from blackbodies.
  [[nodiscard]] const SourceLayout& layout() const { return layout_; }
  // The i-th of those wanted.
  [[nodiscard]] const ConditionSources& wanted(std::size_t i) const { return condition_[i]; }
  // Returns its light under ViewEnvironment::one_sky; null: the condition has one sky.
  [[nodiscard]] const ConditionSources* wanted_under_one_sky(std::size_t i) const {
    return one_sky_[i] ? &*one_sky_[i] : nullptr;
  }

 private:
  std::shared_ptr<const ViewEnvironments> environments_;
  SourceGeometry geometry_;
  SourceLayout layout_;
  std::vector<ConditionSources> condition_;
  std::vector<std::optional<ConditionSources>> one_sky_;
};

// Returns the sea or ground of a condition, or none.
//   horizon  null: seen by straight lines
[[nodiscard]] Boundary boundary_of(const ConditionSpec& condition, double surface_z_m,
                                   const Environment::Horizon* horizon = nullptr);

}  // namespace irsig
