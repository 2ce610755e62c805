#include "tests/unit/vdb_files.h"

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/unit/test_folder.h"

namespace irsig {
namespace {

using namespace openvdb;

math::Transform::Ptr transform_of(const std::string& name) {
  if (name == "frustum")
    return math::Transform::createFrustumTransform(BBoxd({0, 0, 0}, {10, 10, 10}), 0.5, 10, 0.5);
  auto out = math::Transform::createLinearTransform(name == "finer" ? 0.4 : 0.5);
  if (name == "turned") out->postRotate(0.3, math::Z_AXIS);
  if (name == "sheared") out->postShear(0.4, math::X_AXIS, math::Y_AXIS);
  return out;
}

template <typename Grid>
GridBase::Ptr filled(const VdbGrid& how) {
  using Value = typename Grid::ValueType;
  auto grid = Grid::create(Value(how.background));
  auto at = grid->getAccessor();
  for (int i = 0; i < how.size && how.tile == 0; ++i)
    for (int j = 0; j < how.size; ++j)
      for (int k = 0; k < how.size; ++k) at.setValue(Coord(i, j, k), Value(how.value));
  if (how.tile > 0)
    at.addTile(static_cast<Index>(how.tile), Coord(0, 0, 0), Value(how.value), true);
  if (how.has_odd) {
    const Coord where(how.odd_at[0], how.odd_at[1], how.odd_at[2]);
    at.setValue(where, Value(how.odd));
    if (!how.odd_active) at.setValueOff(where);
  }
  return grid;
}

GridBase::Ptr grid_of(const VdbGrid& how) {
  GridBase::Ptr grid = how.type == "double"   ? filled<DoubleGrid>(how)
                       : how.type == "vector" ? filled<Vec3SGrid>(how)
                       : how.type == "bool"   ? filled<BoolGrid>(how)
                                              : filled<FloatGrid>(how);
  grid->setName(how.name);
  grid->setSaveFloatAsHalf(how.type == "half");
  grid->setTransform(transform_of(how.transform));
  if (how.kind == "fog volume") grid->setGridClass(GRID_FOG_VOLUME);
  if (how.kind == "level set") grid->setGridClass(GRID_LEVEL_SET);
  if (how.kind == "staggered") grid->setGridClass(GRID_STAGGERED);
  return grid;
}

}  // namespace

std::string vdb_file(const std::vector<VdbGrid>& how, bool stream) {
  openvdb::initialize();
  GridPtrVec grids;
  for (const VdbGrid& grid : how) grids.push_back(grid_of(grid));
  if (stream) {
    std::ostringstream out;
    io::Stream(out).write(grids);
    return out.str();
  }
  const TestFolder folder;
  const std::string path = folder.file("a.vdb");
  io::File file(path);
  file.write(grids);
  file.close();
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace irsig
