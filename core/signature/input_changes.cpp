#include "core/signature/input_changes.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "core/base/status_macros.h"
#include "core/signature/view/shading.h"
#include "core/signature/view/trace_view.h"
#include "core/signature/view_seed.h"
#include "core/sources/view_sources.h"

namespace irsig {
namespace {

ViewSources sources_of(const MeasuredPaths& measured, const ViewRequest& request) {
  // A pointer into what outlives it.
  const std::shared_ptr<const ViewEnvironments> environments(std::shared_ptr<void>(),
                                                             &measured.view.environments);
  SourceRequest sources =
      source_request(measured.scene, request, measured.request.selected_condition);
  sources.emitters = measured.request.emitters;
  return ViewSources(sources, measured.plan.effects, environments, measured.scene.axis.node_um());
}

// The lights that one condition needs, as in ViewSources for all together.
LightLayout layout_of(const ConditionSpec& condition, const SourceGeometry& geometry,
                      std::size_t parts) {
  LightLayout out;
  out.paths = SourceLayout(parts, geometry);
  std::uint32_t emitters = out.paths.emitters();
  if (condition.emitter && condition.emitter->hottest_k > 0) {
    out.nodes = BlackbodyNodes(condition.emitter->coldest_k, condition.emitter->hottest_k);
    emitters = static_cast<std::uint32_t>(parts) + out.nodes.count();
  }
  out.light = SourceLayout::of_light(emitters, geometry);
  return out;
}

}  // namespace

absl::StatusOr<std::vector<RowChange>> row_changes(const MeasuredPaths& measured,
                                                   const MovedView& moved) {
  const PreparedScene& scene = moved.scene ? *moved.scene : measured.scene;
  const std::size_t parts = scene.target.part.size();
  if (scene.axis.node_um() != measured.scene.axis.node_um() ||
      moved.request.condition.size() != measured.request.condition.size())
    return absl::InternalError("a moved view has other wavelengths or conditions than the view");
  ViewRequest request = moved.request;
  for (std::size_t c = 0; c < request.condition.size(); ++c) {
    const ConditionSpec& from = measured.request.condition[c];
    ConditionSpec& to = request.condition[c];
    to.sun = from.sun;
    to.sun_direction = from.sun_direction;
    to.sun_cos_zenith = from.sun_cos_zenith;
    to.sun_angular_radius_deg = from.sun_angular_radius_deg;
    to.sun_horizon_z = from.sun_horizon_z;
  }
  const ViewSources as_measured = sources_of(measured, measured.request),
                    sources = sources_of(measured, request);
  std::vector<PathWeights> own;
  std::span<const PathWeights> weights = measured.weights;
  if (moved.scene || sources.geometry().sun != as_measured.geometry().sun) {
    own = trace_view(scene, *measured.view.aimed, sources.geometry(),
                     path_settings(measured.request.accuracy, measured.plan.effects,
                                   view_seed(measured.scene, measured.request) + kStoredStage,
                                   measured.plan.samples_per_replicate))
              .weights;
    weights = own;
  }

  std::optional<ViewSurroundings> surroundings;
  if (request.environment == nullptr || request.environment != measured.request.environment) {
    ASSIGN_OR_RETURN(auto made, ViewSurroundings::make(
                                    request, scene.target, measured.request.viewpoint.range_m,
                                    scene.axis.node_um(), &measured.view.environments.behind));
    surroundings.emplace(std::move(made));
  }
  std::vector<RowChange> out;
  std::vector<RowTally> tally;
  for (std::size_t i = 0; i < measured.request.selected_condition.size(); ++i) {
    const std::uint32_t c = measured.request.selected_condition[i];
    ViewEnvironment moved_air;
    const ViewEnvironment* environment = &measured.view.environments.condition[c];
    if (surroundings) {
      ASSIGN_OR_RETURN(
          moved_air, surroundings->see_like(measured.view.environments, c, measured.plan.effects));
      environment = &moved_air;
      if (environment->around.count() != sources.geometry().directions.count() ||
          environment->background_apparent.size() !=
              measured.view.environments.condition[c].background_apparent.size())
        return absl::InternalError("a moved air has other directions than the view");
    }
    std::vector<LitSun> suns;
    for (const LitSun& sun : sources.wanted(i).suns())
      suns.push_back({sun.index, sun.direct, environment->sun, environment->sun_apparent});
    const ConditionSources light(request.condition[c], *environment, sources.geometry(),
                                 layout_of(request.condition[c], sources.geometry(), parts),
                                 std::move(suns), scene.axis.node_um(), measured.plan.effects,
                                 scene.land_emissivity);
    const LitWeights lit(light, weights, parts);
    for (std::size_t b = 0; b < measured.request.selected_band.size(); ++b) {
      const BandOnAxis band = scene.axis.band(measured.request.selected_band[b]);
      tally_row(light, parts, lit, scene.path_basis(), band,
                source_table(light, scene.path_basis(), band.first_node, band.grid.band_weight),
                false, tally);
      const SignatureResult& row = measured.result.row[out.size()];
      ReplicateStatistics change(3);
      for (std::size_t r = 0; r < tally.size(); ++r)
        change.add(std::array{tally[r].total - row.replicate_w_sr[r],
                              tally[r].apparent - row.replicate_apparent_w_sr[r],
                              tally[r].contrast - row.replicate_contrast_w_sr[r]});
      out.push_back({change.estimate(0), change.estimate(1), change.estimate(2)});
    }
  }
  return out;
}

}  // namespace irsig
