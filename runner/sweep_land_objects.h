#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "core/land/height_field.h"
#include "core/land/land_cover.h"
#include "core/land/objects/land_objects.h"
#include "schema/assets.h"
#include "schema/job.pb.h"

namespace irsig {

// Returns the objects of [[land.object]], with their meshes, standing on the land. Null: there are
// none. assets: with the files of [land]. INVALID_ARGUMENT "land.object[...]...": a model or a file
// of places that cannot be read, a group without a material, a part without a group, places beyond
// the map, and errors of LandObjects::create and scatter_objects.
[[nodiscard]] absl::StatusOr<std::shared_ptr<const LandObjects>> land_objects_from_sweep(
    const schema::ResolvedSweep& sweep, const Assets& assets, const HeightField& field,
    const LandCover& cover);

}  // namespace irsig
