#include <openvdb/openvdb.h>

#include <sstream>

#include "core/plume/volume/vdb_volume.h"

namespace irsig {
namespace {

using openvdb::FloatGrid;

// Writes a file that has the places of its grids in it, as io::File does.
class SeekableArchive : public openvdb::io::Archive {
 public:
  SeekableArchive() {
    setCompression(openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK);
  }
  void write(std::ostream& out, const openvdb::GridPtrVec& grids) const {
    Archive::write(out, grids, true);
  }
};

FloatGrid::Ptr grid_of(const VoxelVolume& volume, std::size_t channel) {
  FloatGrid::Ptr grid = FloatGrid::create(volume.background[channel]);
  grid->setName(volume.channel[channel]);
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  const auto& m = volume.world_from_index;
  grid->setTransform(openvdb::math::Transform::createLinearTransform(
      openvdb::math::Mat4d(m[0], m[4], m[8], 0.0, m[1], m[5], m[9], 0.0, m[2], m[6], m[10], 0.0,
                           m[3], m[7], m[11], 1.0)));
  const std::size_t channels = volume.channel.size();
  FloatGrid::Accessor at = grid->getAccessor();
  std::size_t first = 0;
  for (std::size_t b = 0; b < volume.block.size(); ++b) {
    const VoxelBlock& block = volume.block[b];
    const VoxelMask held = held_by_any(volume, b), &mask = volume.mask[b * channels + channel];
    const openvdb::Coord origin(block.origin[0], block.origin[1], block.origin[2]);
    const auto value = [&](std::size_t voxel) {
      return volume.value[(first + voxel) * channels + channel];
    };
    if (block.form == VoxelBlock::Form::kUniform) {
      at.addTile(1, origin, value(0), true);
    } else if (count_of(mask) > 0) {
      FloatGrid::TreeType::LeafNodeType* leaf = at.touchLeaf(origin);
      std::size_t stored = 0;
      for (unsigned v = 0; v < 512; ++v) {
        if (holds(mask, v)) leaf->setValueOn(v, value(stored));
        stored += block.form == VoxelBlock::Form::kDense || holds(held, v);
      }
    }
    first += stored_voxels(block.form, held);
  }
  return grid;
}

}  // namespace

absl::StatusOr<std::string> write_vdb(const VoxelVolume& volume) {
  openvdb::initialize();
  openvdb::GridPtrVec grids;
  for (std::size_t c = 0; c < volume.channel.size(); ++c) grids.push_back(grid_of(volume, c));
  try {
    std::ostringstream out;
    SeekableArchive().write(out, grids);
    return std::move(out).str();
  } catch (const openvdb::Exception& e) {
    return absl::InternalError(e.what());
  }
}

}  // namespace irsig
