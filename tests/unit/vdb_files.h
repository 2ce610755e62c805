#pragma once

#include <array>
#include <string>
#include <vector>

namespace irsig {

// VDB files as other programs write them, right and wrong. Grids of 4 x 4 x 4 active voxels from
// (0, 0, 0), of `value`.
struct VdbGrid {
  std::string name;
  double value = 0;
  std::string type = "float";       // float, double, vector, half (float, stored as half), bool
  std::string kind = "fog volume";  // fog volume, level set, staggered, none
  std::string transform = "plain";  // plain (0.5 m), finer, turned, sheared, frustum
  double background = 0;
  int size = 4;  // 0: empty
  // One voxel of another value, and whether it is active.
  std::array<int, 3> odd_at{};
  double odd = 0;
  bool has_odd = false, odd_active = true;
  int tile = 0;  // 1, 2, 3: an active tile of 8, 128 or 4096 voxels instead of voxels
};
// stream: without the places of grids in the file.
[[nodiscard]] std::string vdb_file(const std::vector<VdbGrid>& grids, bool stream = false);

}  // namespace irsig
