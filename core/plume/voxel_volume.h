#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// 8 x 8 x 8 voxels. Voxel (x, y, z) of it, each 0 to 7, has the offset 64 x + 8 y + z.
struct VoxelBlock {
  enum class Form : std::uint32_t {
    kPacked = 0,   // values of the voxels that any channel holds, by offset
    kDense = 1,    // of all 512
    kUniform = 2,  // one voxel's, for all 512
  };
  std::array<std::int32_t, 3> origin{};  // of its first voxel, multiples of 8
  Form form = Form::kPacked;
};

using VoxelMask = std::array<std::uint64_t, 8>;  // bit (offset % 64) of word (offset / 64)

[[nodiscard]] constexpr bool holds(const VoxelMask& mask, unsigned offset) {
  return (mask[offset >> 6] >> (offset & 63) & 1) != 0;
}
[[nodiscard]] constexpr unsigned count_of(const VoxelMask& mask) {
  unsigned count = 0;
  for (const std::uint64_t word : mask) count += static_cast<unsigned>(std::popcount(word));
  return count;
}

// Sparse volumes of float, several channels on one lattice: all that is taken from a VDB file, and
// all that one is written from. Index coordinates are those of OpenVDB: voxel (i, j, k) is centred
// at the world point world_from_index (i, j, k, 1).
struct VoxelVolume {
  std::array<double, 12> world_from_index{};  // three rows of four
  std::vector<std::string> channel;           // names of grids
  std::vector<float> background;              // one a channel: what an inactive voxel holds
  std::vector<VoxelBlock> block;              // in any order, none twice
  std::vector<VoxelMask> mask;                // active voxels; [block][channel]
  // [block][voxel][channel], voxels as the block's form says. 0 where a channel is inactive.
  std::vector<float> value;
};

// Returns the voxels of block b that any channel holds.
[[nodiscard]] VoxelMask held_by_any(const VoxelVolume& volume, std::size_t b);
// Returns the number of voxels of a block that have values.
[[nodiscard]] std::size_t stored_voxels(VoxelBlock::Form form, const VoxelMask& held);

// Adds blocks voxel by voxel, in the smallest form of each.
class VolumeWriter {
 public:
  explicit VolumeWriter(VoxelVolume& volume) : volume_(volume) {}
  // Adds a block; nothing where no voxel is active. mask: [channel]; value: [voxel of
  // 512][channel].
  void add(std::array<std::int32_t, 3> origin, const std::vector<VoxelMask>& mask,
           const std::vector<float>& value);
  // Adds a block with all 512 voxels active and the same values.
  void add_uniform(std::array<std::int32_t, 3> origin, const std::vector<float>& value);

 private:
  VoxelVolume& volume_;
};

// More blocks than this are refused, by readers and by generators: 2e9 voxels.
inline constexpr std::uint64_t kMostBlocks = 4'000'000;

// Encodes a volume, or an error, as bytes between two processes of one build on one machine.
[[nodiscard]] std::string encode_volume(const absl::StatusOr<VoxelVolume>& volume);
// Trusts nothing: DATA_LOSS where the bytes are no complete volume of the shape above (finiteness
// is not looked at); INVALID_ARGUMENT with what the other process said.
[[nodiscard]] absl::StatusOr<VoxelVolume> decode_volume(std::string_view bytes);

}  // namespace irsig
