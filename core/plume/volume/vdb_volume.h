#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/plume/voxel_volume.h"

namespace irsig {

// The grids of those names of a VDB file, as channels in that order, on the blocks that any of them
// holds. INVALID_ARGUMENT with the grid's name and what is there: missing, twice, without a name,
// not of float, a level set or staggered, without active voxels, not affine, not on the lattice of
// the first; more blocks than kMostBlocks.
[[nodiscard]] absl::StatusOr<VoxelVolume> read_vdb(std::string file,
                                                   const std::vector<std::string>& names);

// A VDB file with a grid of float, class fog volume, for each channel; zipped.
[[nodiscard]] absl::StatusOr<std::string> write_vdb(const VoxelVolume& volume);

}  // namespace irsig
