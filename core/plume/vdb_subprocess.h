#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/plume/voxel_volume.h"

namespace irsig {

// OpenVDB runs in irsig-volume, a process of its own: damaged files crash it, and nobody else has
// to load it (docs/decisions/0021, core/base/run_subprocess.h). May be called from several threads
// at once.

// Reads the named grids of a VDB file. INVALID_ARGUMENT: the file is faulty (volume/vdb_volume.h),
// or the process crashed or met a limit. INTERNAL: the process could not be run.
[[nodiscard]] absl::StatusOr<VoxelVolume> read_vdb_apart(std::string_view file,
                                                         const std::vector<std::string>& grids);

// Returns the bytes of a VDB file with a grid for each channel.
[[nodiscard]] absl::StatusOr<std::string> write_vdb_apart(const VoxelVolume& volume);

// Encodes the reply of irsig-volume: the bytes of a file, or the error.
[[nodiscard]] std::string encode_vdb(const absl::StatusOr<std::string>& file);

}  // namespace irsig
