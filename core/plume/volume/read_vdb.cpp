#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "core/base/status_macros.h"
#include "core/plume/volume/vdb_archive.h"
#include "core/plume/volume/vdb_volume.h"
#include "fmt/format.h"

namespace irsig {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using Tree = openvdb::FloatTree;
using Leaf = Tree::LeafNodeType;
static_assert(Leaf::SIZE == 512 && Leaf::DIM == 8);

absl::Status refuse(const std::string& what) { return absl::InvalidArgumentError(what); }

std::string quoted(const std::string& name) {
  return name.empty() ? "(without a name)" : "\"" + name + "\"";
}

std::string what_is_there(const VdbArchive::Entry& entry) {
  return fmt::format("{} ({})", quoted(entry.name), entry.value_type);
}

std::string what_is_there(const std::vector<VdbArchive::Entry>& entries) {
  if (entries.empty()) return "the file has no grids";
  std::string out = "the file has ";
  constexpr std::size_t kListed = 20;
  for (std::size_t i = 0; i < std::min(kListed, entries.size()); ++i)
    out += (i == 0 ? "" : ", ") + what_is_there(entries[i]);
  return entries.size() > kListed ? out + fmt::format(" and {} more", entries.size() - kListed)
                                  : out;
}

absl::StatusOr<VdbArchive::Entry*> find(VdbArchive& archive, const std::string& name) {
  VdbArchive::Entry* found = nullptr;
  std::size_t count = 0;
  for (VdbArchive::Entry& entry : archive.entries()) {
    if (entry.name != name) continue;
    found = &entry;
    ++count;
  }
  if (count == 0)
    return refuse(fmt::format("no grid {}; {}", quoted(name), what_is_there(archive.entries())));
  if (count > 1)
    return refuse(fmt::format("grid {} is there {} times, expected once; {}", quoted(name), count,
                              what_is_there(archive.entries())));
  return found;
}

// World from index, three rows of four; a reason where the map is not affine.
absl::StatusOr<std::array<double, 12>> affine(const openvdb::math::Transform& transform) {
  if (!transform.isLinear())
    return refuse(
        fmt::format("its transform is a {}, whose voxels are no parallelepipeds of one size: "
                    "expected an affine "
                    "transform (resample the grid on one)",
                    transform.mapType()));
  const openvdb::math::Mat4d m = transform.baseMap()->getAffineMap()->getMat4();
  std::array<double, 12> rows{};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c)  // OpenVDB multiplies row vectors from the left
      rows[static_cast<std::size_t>(4 * r + c)] = m(c, r);
  for (const double x : rows)
    if (!std::isfinite(x)) return refuse("its transform is not finite");
  return rows;
}

bool same_lattice(const std::array<double, 12>& a, const std::array<double, 12>& b) {
  double voxel = 0;
  for (std::size_t i = 0; i < 12; ++i)
    if (i % 4 != 3) voxel = std::max(voxel, std::abs(a[i]));
  for (std::size_t i = 0; i < 12; ++i) {
    const double scale = i % 4 == 3 ? std::max(voxel, std::abs(a[i])) : voxel;
    if (!(std::abs(a[i] - b[i]) <= 1e-9 * scale)) return false;
  }
  return true;
}

std::string printed(const std::array<double, 12>& m) {
  return fmt::format("[{:g} {:g} {:g}; {:g} {:g} {:g}; {:g} {:g} {:g}] + ({:g}, {:g}, {:g})", m[0],
                     m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10], m[3], m[7], m[11]);
}

absl::StatusOr<FloatGrid::Ptr> read_grid(VdbArchive& archive, const std::string& name) {
  ASSIGN_OR_RETURN(VdbArchive::Entry * found, find(archive, name));
  VdbArchive::Entry& entry = *found;
  if (!entry.grid->isType<FloatGrid>())
    return refuse(fmt::format("grid {} is of {} ({}), expected float in the standard tree",
                              quoted(name), entry.value_type, entry.grid->type()));
  archive.read(entry);
  const openvdb::GridClass kind = entry.grid->getGridClass();
  if (kind != openvdb::GRID_UNKNOWN && kind != openvdb::GRID_FOG_VOLUME)
    return refuse(fmt::format("grid {} is a {}, expected a fog volume or no class", quoted(name),
                              openvdb::GridBase::gridClassToMenuName(kind)));
  FloatGrid::Ptr grid = openvdb::gridPtrCast<FloatGrid>(entry.grid);
  if (grid->empty() || grid->activeVoxelCount() == 0)
    return refuse(fmt::format("grid {} is empty: no voxel of it is active", quoted(name)));
  return grid;
}

// Calls visit(origin) for each block of 8^3 that the grid holds: leaves and parts of active tiles.
template <typename Visit>
void for_each_block(const FloatGrid& grid, const Visit& visit) {
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf)
    if (!leaf->isEmpty()) visit(leaf->origin());
  auto tile = grid.tree().cbeginValueOn();
  tile.setMaxDepth(Tree::DEPTH - 2);  // tiles only
  for (; tile; ++tile) {
    openvdb::CoordBBox box;
    tile.getBoundingBox(box);
    for (int x = box.min().x(); x <= box.max().x(); x += 8)
      for (int y = box.min().y(); y <= box.max().y(); y += 8)
        for (int z = box.min().z(); z <= box.max().z(); z += 8) visit(Coord(x, y, z));
  }
}

std::uint64_t count_blocks(const FloatGrid& grid) {
  std::uint64_t count = grid.tree().leafCount();
  auto tile = grid.tree().cbeginValueOn();
  tile.setMaxDepth(Tree::DEPTH - 2);
  for (; tile; ++tile) count += tile.getVoxelCount() / 512;
  return count;
}

VoxelMask mask_of(const Leaf& leaf) {
  VoxelMask out;
  for (openvdb::Index w = 0; w < 8; ++w) out[w] = leaf.valueMask().getWord<std::uint64_t>(w);
  return out;
}

void add_blocks(const std::vector<FloatGrid::Ptr>& grids, std::vector<Coord> origins,
                VoxelVolume& out) {
  std::sort(origins.begin(), origins.end());
  origins.erase(std::unique(origins.begin(), origins.end()), origins.end());
  std::vector<FloatGrid::ConstAccessor> at;
  for (const FloatGrid::Ptr& grid : grids) at.push_back(grid->getConstAccessor());
  const std::size_t channels = grids.size();
  std::vector<float> value(512 * channels), one(channels);
  std::vector<VoxelMask> mask(channels);
  VolumeWriter writer(out);
  for (const Coord& origin : origins) {
    const std::array<std::int32_t, 3> where{origin.x(), origin.y(), origin.z()};
    bool uniform = true;
    for (std::size_t c = 0; c < channels; ++c) {
      const Leaf* leaf = at[c].probeConstLeaf(origin);
      const bool on = leaf == nullptr && at[c].probeValue(origin, one[c]);
      uniform = uniform && on;
      mask[c] = leaf != nullptr ? mask_of(*leaf) : VoxelMask{};
      if (on) mask[c].fill(~0ULL);
      for (unsigned v = 0; v < 512; ++v)
        value[v * channels + c] = leaf != nullptr ? leaf->getValue(v) : one[c];
    }
    if (uniform) {
      writer.add_uniform(where, one);
    } else {
      writer.add(where, mask, value);
    }
  }
}

absl::StatusOr<VoxelVolume> read(std::istream& in, const std::vector<std::string>& names) {
  VdbArchive archive(in);
  VoxelVolume out;
  std::vector<FloatGrid::Ptr> grids;
  std::uint64_t blocks = 0;
  for (const std::string& name : names) {
    ASSIGN_OR_RETURN(const FloatGrid::Ptr grid, read_grid(archive, name));
    const absl::StatusOr<std::array<double, 12>> map = affine(grid->transform());
    if (!map.ok())
      return refuse(fmt::format("grid {}: {}", quoted(name), std::string(map.status().message())));
    if (grids.empty()) out.world_from_index = *map;
    if (!same_lattice(out.world_from_index, *map))
      return refuse(fmt::format(
          "grids {} and {} lie on different lattices, {} and {}: expected one transform",
          quoted(names[0]), quoted(name), printed(out.world_from_index), printed(*map)));
    blocks += count_blocks(*grid);
    if (blocks > kMostBlocks * names.size())
      return refuse(fmt::format(
          "grid {} holds {} blocks of 8^3 voxels, expected at most {}: is a background active?",
          quoted(name), count_blocks(*grid), kMostBlocks));
    grids.push_back(grid);
    out.channel.push_back(name);
    out.background.push_back(grid->background());
  }
  std::vector<Coord> origins;
  origins.reserve(blocks);
  for (const FloatGrid::Ptr& grid : grids)
    for_each_block(*grid, [&](const Coord& origin) { origins.push_back(origin); });
  for (const Coord& at : origins)
    if (((at.x() | at.y() | at.z()) & 7) != 0)
      return refuse(
          fmt::format("a block of voxels begins at ({}, {}, {}), expected multiples of 8: "
                      "the file is damaged",
                      at.x(), at.y(), at.z()));
  add_blocks(grids, std::move(origins), out);
  if (out.block.size() > kMostBlocks)
    return refuse(
        fmt::format("{} blocks of 8^3 voxels, expected at most {}", out.block.size(), kMostBlocks));
  return out;
}

}  // namespace

absl::StatusOr<VoxelVolume> read_vdb(std::string file, const std::vector<std::string>& names) {
  openvdb::initialize();
  try {
    std::istringstream in(std::move(file));
    return read(in, names);
  } catch (const openvdb::Exception& e) {
    return refuse(fmt::format("it is no VDB file that can be read: {}", e.what()));
  }
}

}  // namespace irsig
