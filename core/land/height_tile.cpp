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

// An upper bound of the slopes of triangles in cells [west, east) x [south, north).
float steepest_of(const HeightGrid& grid, int west, int east, int south, int north) {
  double most_m2 = 0;  // squares of the rise along a cell's side
  for (int row = south; row < north; ++row) {
    const float* z =
        grid.z_m.data() + static_cast<std::size_t>(row) * (grid.columns + std::size_t{1});
    const float* up = z + grid.columns + 1;
    for (int c = west; c < east; ++c) {
      const double of_south = double(z[c + 1]) - z[c], of_east = double(up[c + 1]) - z[c + 1],
                   of_north = double(up[c + 1]) - up[c], of_west = double(up[c]) - z[c];
      most_m2 = std::max({most_m2, of_south * of_south + of_east * of_east,
                          of_north * of_north + of_west * of_west});
    }
  }
  constexpr double kRoundedUp = 1 + 1e-6;  // of a float
  return static_cast<float>(kRoundedUp * std::sqrt(most_m2) / grid.spacing_m);
}

}  // namespace

HeightTile::HeightTile(HeightGrid grid) : grid_(std::move(grid)) {
  const auto add_level = [this](int below_columns, int below_rows) {
    const int columns = blocks_along(below_columns), rows = blocks_along(below_rows);
    const std::size_t blocks = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    level_.push_back({columns, rows, std::vector<HeightRange>(blocks, kEmptyRange),
                      std::vector<float>(blocks, 0.0f)});
  };
  add_level(columns(), rows());
  std::size_t block = 0;
  for (int row = 0; row < rows(); row += 1 << kBits)
    for (int column = 0; column < columns(); column += 1 << kBits, ++block) {
      const int east = std::min(columns(), column + (1 << kBits)),
                north = std::min(rows(), row + (1 << kBits));
      level_[0].range[block] = range_of(grid_, column, east, row, north);
      level_[0].steepest[block] = steepest_of(grid_, column, east, row, north);
    }
  while (level_.back().range.size() > 1) {
    add_level(level_.back().columns, level_.back().rows);
    const Level& below = level_[level_.size() - 2];
    Level& here = level_.back();
    for (int row = 0; row < below.rows; ++row)
      for (int column = 0; column < below.columns; ++column) {
        const auto to = static_cast<std::size_t>((row >> kBits) * here.columns + (column >> kBits));
        const std::size_t from =
            static_cast<std::size_t>(row) * static_cast<std::size_t>(below.columns) +
            static_cast<std::size_t>(column);
        include(here.range[to], below.range[from]);
        here.steepest[to] = std::max(here.steepest[to], below.steepest[from]);
      }
  }
}

void HeightTile::widen(int column, int row, HeightRange by, float steepest) {
  for (int level = 1; level <= top(); ++level) {
    Level& of = level_[static_cast<std::size_t>(level - 1)];
    const std::size_t block =
        static_cast<std::size_t>(row >> (kBits * level)) * static_cast<std::size_t>(of.columns) +
        static_cast<std::size_t>(column >> (kBits * level));
    include(of.range[block], by);
    of.steepest[block] = std::max(of.steepest[block], steepest);
  }
}

void HeightTile::cover(const CellBlock& cells, const HeightGrid& finer, int fineness) {
  for (int row = cells.south; row < cells.north; ++row)
    for (int column = cells.west; column < cells.east; ++column) {
      const int west = (column - cells.west) * fineness, south = (row - cells.south) * fineness;
      const int east = west + fineness, north = south + fineness;
      widen(column, row, range_of(finer, west, east, south, north),
            steepest_of(finer, west, east, south, north));
    }
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
