#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/plume/voxel_volume.h"

namespace irsig {

// Reads the named grids of a VDB file as channels, in the order of the names, on the blocks that
// any of them holds. INVALID_ARGUMENT with the grid's name and its fault: missing, twice, without a
// name, not of float, a level set or staggered, without active voxels, not affine, not on the
// lattice of the first; more blocks than kMostBlocks.
[[nodiscard]] absl::StatusOr<VoxelVolume> read_vdb(std::string file,
                                                   const std::vector<std::string>& names);

// Writes a zipped VDB file with a grid of float, class fog volume, for each channel.
[[nodiscard]] absl::StatusOr<std::string> write_vdb(const VoxelVolume& volume);

}  // namespace irsig
