#include "cli/target_extent.h"

#include <utility>

#include "core/base/status_macros.h"
#include "core/scene/trace/target.h"
#include "runner/spec_to_request.h"
#include "view/moved/range_change.h"
#include "view/moved/silhouette.h"

namespace irsig {

absl::StatusOr<TargetExtent> stored_target_extent(const StoredSweep& sweep) {
  ASSIGN_OR_RETURN(auto scene, scene_from_sweep(sweep.resolved, sweep.assets, sweep.heat));
  ASSIGN_OR_RETURN(const auto part_of_group, part_of_groups(scene.mesh, scene.part));
  TargetExtent out = target_extent(scene.mesh.vertex);
  auto shape = std::make_shared<TargetShape>();
  for (const PartSpec& part : scene.part) shape->two_sided.push_back(part.two_sided);
  for (const std::uint32_t group : scene.mesh.triangle_group)
    shape->part.push_back(part_of_group[group]);
  shape->vertex = std::move(scene.mesh.vertex);
  shape->triangle = std::move(scene.mesh.triangle);
  out.shape = std::move(shape);
  return out;
}

}  // namespace irsig
