#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/environment/environment.h"
#include "core/signature/view/plan.h"
#include "core/signature/view/prepared_scene.h"
#include "core/signature/view/request.h"
#include "core/signature/view/unseen.h"
#include "core/sources/view_sources.h"
#include "core/transport/primary_rays.h"

namespace irsig {

// All of a view that no random number decides.
struct PreparedView {
  std::shared_ptr<const AimedView> aimed;
  ViewEnvironments environments;
  EffectSet effects;  // for which the environments were made
  std::shared_ptr<const UndersampledSources> unseen = nullptr;  // null: whoever needs it makes it
};

// Returns what the sources of a view are made from. The result refers to its arguments.
[[nodiscard]] SourceRequest source_request(const PreparedScene& scene, const ViewRequest& request,
                                           std::span<const std::uint32_t> wanted);

// Returns Land::bend_of for a sensor in the air of an environment; 0: there is none.
//   above_m  height of the target's reference point above the land below it
[[nodiscard]] double land_bend_per_m(const Environment* environment, const Viewpoint& viewpoint,
                                     double above_m);
// Returns the land around the target of a request with land, for a sensor at that range.
[[nodiscard]] Land land_of(const ViewRequest& request, const Target& target, double range_m);
// Returns increasing ranges (SensorLine::land_range_m) for land that rays of a sensor meet at these
// distances; infinity: a ray meets none. Empty if none meets any.
[[nodiscard]] std::vector<double> land_ranges_m(std::span<const double> distance_m);

// The surroundings and the air of a request, with an atmosphere or without, seen along one line.
class ViewSurroundings {
 public:
  // Makes the surroundings of a view. The request and the wavelengths outlive them.
  // INVALID_ARGUMENT as in Environment::view().
  //   behind, land_range_m  where the background is wanted; null: where these conditions need it
  [[nodiscard]] static absl::StatusOr<ViewSurroundings> make(
      const ViewRequest& request, const Target& target, double range_m,
      const std::vector<double>& node_um, const BackgroundDirections* behind = nullptr,
      const std::vector<double>* land_range_m = nullptr);

  // The most that light can be, before any sky is computed.
  [[nodiscard]] const LightBounds& bounds(std::uint32_t condition);
  // Returns the most that light can change if a condition's cloud is left out. nullopt: it has no
  // cloud, or none is left out: where target or line of sight reach it, before land, with hot gas,
  // and in views with images, which show their sky.
  [[nodiscard]] std::optional<CloudBounds> cloud_bounds(std::uint32_t condition);
  // Computes emission and the line's air alone, for a pilot without reflections.
  [[nodiscard]] ViewEnvironments without_light();
  // Returns the environments of these conditions, as far as these effects need them.
  [[nodiscard]] absl::StatusOr<ViewEnvironments> evaluate(std::span<const std::uint32_t> conditions,
                                                          const EffectSet& effects);
  // Computes one condition, in the directions of another view's light.
  [[nodiscard]] absl::StatusOr<ViewEnvironment> see_like(const ViewEnvironments& other,
                                                         std::uint32_t condition,
                                                         const EffectSet& effects);

 private:
  ViewSurroundings(const ViewRequest& request, double range_m, const std::vector<double>& node_um);
  [[nodiscard]] const LightBounds& land_bounds(std::uint32_t condition);
  [[nodiscard]] const LightBounds& surrounding_bounds(std::uint32_t condition);  // without land

  const ViewRequest* request_;
  double range_m_;
  const std::vector<double>* node_um_;
  std::vector<Environment::Line::End> end_;
  BackgroundDirections behind_;
  std::vector<double> land_range_m_;  // SensorLine::land_range_m
  double land_bend_per_m_ = 0;        // Land::bend_of
  std::optional<Environment::Horizon> horizon_;
  std::optional<Environment::SightLine> look_;
  // [condition] Without an atmosphere; with land.
  std::vector<std::optional<LightBounds>> plain_bounds_, land_bounds_;
};

// Computes some conditions with all effects.
[[nodiscard]] absl::StatusOr<ViewEnvironments> view_environments(
    const ViewRequest& request, const Target& target, double range_m,
    std::span<const std::uint32_t> conditions, const std::vector<double>& node_um);

// Returns a plan with all effects, as many reflections as the request allows, and no number of
// samples.
[[nodiscard]] ViewPlan plan_with_everything(const ViewRequest& request);

}  // namespace irsig
