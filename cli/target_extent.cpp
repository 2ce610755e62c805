#include "cli/target_extent.h"

#include "bridge/spec_to_request.h"
#include "view/range_change.h"

namespace irsig {

absl::StatusOr<TargetExtent> stored_target_extent(const StoredSweep& sweep) {
  const auto scene = scene_from_sweep(sweep.resolved, sweep.assets, sweep.heat);
  if (!scene.ok()) return scene.status();
  return target_extent(scene->mesh.vertex);
}

}  // namespace irsig
