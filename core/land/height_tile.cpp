#include "core/land/height_tile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace irsig {
namespace {

constexpr HeightRange kEmptyRange{std::numeric_limits<float>::infinity(),
                                  -std::numeric_limits<float>::infinity()};

void include(HeightRange& range, HeightRange other) {
  range.lowest = std::min(range.lowest, other.lowest);
  range.highest = std::max(range.highest, other.highest);
}

int blocks_along(int cells) { return (cells + (1 << HeightTile::kBits) - 1) >> HeightTile::kBits; }

// The heights of vertices [west, east] x [south, north].
HeightRange range_of(const HeightGrid& grid, int west, int east, int south, int north) {
  HeightRange out = kEmptyRange;
  for (int row = south; row <= north; ++row) {
    const float* z =
        grid.z_m.data() + static_cast<std::size_t>(row) * (grid.columns + std::size_t{1});
    for (int column = west; column <= east; ++column) include(out, {z[column], z[column]});
  }
  return out;
}

// The steeper slope of a cell's two triangles, as a tangent, rounded up.
float slope_of(const HeightGrid& grid, int column, int row) {
  const float* south = grid.z_m.data() +
                       static_cast<std::size_t>(row) * (grid.columns + std::size_t{1}) +
                       static_cast<std::size_t>(column);
  const float* north = south + grid.columns + 1;
  const double southwest = south[0], southeast = south[1], northwest = north[0],
               northeast = north[1];
  const auto rise2_m2 = [](double east_m, double north_m) {
    return east_m * east_m + north_m * north_m;
  };
  constexpr double kRounding = 1e-6;
  return static_cast<float>(
      (1 + kRounding) / grid.spacing_m *
      std::sqrt(std::max(rise2_m2(southeast - southwest, northeast - southeast),
                         rise2_m2(northeast - northwest, northwest - southwest))));
}

// The cell at a coordinate, among so many.
int cell_of(double coordinate, int cells) {
  return std::clamp(static_cast<int>(coordinate), 0, cells - 1);
}

}  // namespace

HeightTile::HeightTile(HeightGrid grid) : grid_(std::move(grid)) {
  const auto add_level = [this](int below_columns, int below_rows) {
    const int columns = blocks_along(below_columns), rows = blocks_along(below_rows);
    level_.push_back(
        {columns,
         rows,
         std::vector<HeightRange>(
             static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), kEmptyRange),
         {}});
    if (top() >= kLeastSteepLevel) level_.back().steepest.resize(level_.back().range.size());
  };
  add_level(columns(), rows());
  auto range = level_[0].range.begin();
  for (int row = 0; row < rows(); row += 1 << kBits)
    for (int column = 0; column < columns(); column += 1 << kBits)
      *range++ = range_of(grid_, column, std::min(columns(), column + (1 << kBits)), row,
                          std::min(rows(), row + (1 << kBits)));
  while (level_.back().range.size() > 1) {
    add_level(level_.back().columns, level_.back().rows);
    const Level& below = level_[level_.size() - 2];
    Level& here = level_.back();
    for (int row = 0; row < below.rows; ++row)
      for (int column = 0; column < below.columns; ++column)
        include(here.range[here.index(column >> kBits, row >> kBits)],
                below.range[below.index(column, row)]);
  }
  for (int row = 0; row < rows(); ++row)
    for (int column = 0; column < columns(); ++column)
      include_slope(column, row, slope_of(grid_, column, row));
}

// Slopes of larger blocks are those of their parts.
void HeightTile::include_slope(int column, int row, float slope) {
  for (int level = kLeastSteepLevel; level <= top(); ++level) {
    Level& of = level_[static_cast<std::size_t>(level - 1)];
    float& most = of.steepest[of.index(column >> (kBits * level), row >> (kBits * level))];
    if (slope <= most) return;
    most = slope;
  }
}

void HeightTile::widen(int column, int row, HeightRange by, float slope) {
  for (int level = 1; level <= top(); ++level) {
    Level& of = level_[static_cast<std::size_t>(level - 1)];
    include(of.range[of.index(column >> (kBits * level), row >> (kBits * level))], by);
  }
  include_slope(column, row, slope);
}

void HeightTile::cover(const CellBlock& cells, const HeightGrid& finer, int fineness) {
  for (int row = cells.south; row < cells.north; ++row)
    for (int column = cells.west; column < cells.east; ++column) {
      const int west = (column - cells.west) * fineness, south = (row - cells.south) * fineness;
      float slope = 0;
      for (int j = south; j < south + fineness; ++j)
        for (int i = west; i < west + fineness; ++i) slope = std::max(slope, slope_of(finer, i, j));
      widen(column, row, range_of(finer, west, west + fineness, south, south + fineness), slope);
    }
}

double HeightTile::surface_m(double x, double y) const {
  const int column = cell_of(x, columns()), row = cell_of(y, rows());
  const float* south = corner(column, row);
  const float* north = south + columns() + 1;
  const double u = std::clamp(x - column, 0.0, 1.0), v = std::clamp(y - row, 0.0, 1.0);
  const bool southeast = x - column >= y - row;
  const double southwest = south[0], middle = southeast ? south[1] : north[0];
  return southwest + (southeast ? u : v) * (middle - southwest) +
         (southeast ? v : u) * (double{north[1]} - middle);
}

float HeightTile::highest_m(const CellBlock& cells) const {
  const int west = std::max(cells.west, 0), east = std::min(cells.east, columns()),
            south = std::max(cells.south, 0), north = std::min(cells.north, rows());
  float out = kEmptyRange.highest;
  if (west >= east || south >= north) return out;
  // Blocks of which few cover the rectangle.
  int level = 1;
  while (level < top() && (std::max(east - west, north - south) >> (kBits * level)) > 4) ++level;
  const int shift = kBits * level;
  for (int row = south >> shift; row <= (north - 1) >> shift; ++row)
    for (int column = west >> shift; column <= (east - 1) >> shift; ++column)
      out = std::max(out, range(level, column, row).highest);
  return out;
}

std::size_t HeightTile::memory_bytes() const {
  std::size_t bytes = grid_.z_m.capacity() * sizeof(float);
  for (const Level& level : level_)
    bytes +=
        level.range.capacity() * sizeof(HeightRange) + level.steepest.capacity() * sizeof(float);
  return bytes;
}

}  // namespace irsig
