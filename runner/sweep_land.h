#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/problems.h"
#include "core/environment/environment.h"
#include "core/land/land_scene.h"
#include "core/scene/trace/target.h"
#include "schema/assets.h"
#include "schema/job.pb.h"

namespace irsig {

// Returns the land of a sweep, with its maps read and placed around the target. Null: the sweep has
// no [land]. One land serves all views.
//   assets  with the files of [land]
//   kinds   of land whose temperatures are computed; null: each material is one kind
// INVALID_ARGUMENT "land...": a file that cannot be read, a map that does not contain the target or
// lacks heights where they are needed, a fade that reaches the target, fractions that do not fit
// (LandCover::create), objects that do not stand on the land (land_objects_from_sweep).
[[nodiscard]] absl::StatusOr<std::shared_ptr<const LandScene>> land_from_sweep(
    const schema::ResolvedSweep& sweep, const Assets& assets,
    std::shared_ptr<const LandKinds> kinds = nullptr);

// Checks that no viewpoint has a step at the edge of the map in sight, in the window of the clutter
// or in the image (edge_in_sight). INVALID_ARGUMENT "land.heights": one has. Without land (null)
// there is no edge.
[[nodiscard]] absl::Status check_land_edge(const schema::ResolvedSweep& sweep, const Target& target,
                                           const Environment* environment, const LandScene* land);

// Returns a warning if the map's height at the target differs from that of [place] by more than 10
// m, because air and sky begin at the latter. Adds one if lines of sight to the target leave the
// map before they meet land behind it. Without land (null) there are no warnings.
[[nodiscard]] std::vector<Problem> land_warnings(const schema::ResolvedSweep& sweep,
                                                 const LandScene* land);

// Returns the size of the land's heights, fractions and objects. [bytes] Null: 0.
[[nodiscard]] std::size_t bytes_of(const LandScene* land);

}  // namespace irsig
