#pragma once

#include <cstdint>
#include <vector>

#include "core/land/height_field.h"

namespace irsig {

// Cells [west, east) x [south, north) of a grid.
struct CellBlock {
  int west = 0, east = 0, south = 0, north = 0;
  [[nodiscard]] bool contains(int column, int row) const {
    return column >= west && column < east && row >= south && row < north;
  }
};

struct HeightRange {
  float lowest, highest;
};

// A grid with the ranges of heights and the steepest slopes in its blocks of 4^n x 4^n cells.
// Blocks of 2 x 2 take 47 % more memory and up to 45 % more time for a ray; blocks of 8 x 8 take
// more time for all but random rays
// (docs/decisions/0060-follow-rays-over-land-in-double-without-embree.md).
class HeightTile {
 public:
  static constexpr int kBits = 2;  // log2 of the cells along a side of the smallest block

  explicit HeightTile(HeightGrid grid);

  [[nodiscard]] const HeightGrid& grid() const { return grid_; }
  [[nodiscard]] int columns() const { return static_cast<int>(grid_.columns); }
  [[nodiscard]] int rows() const { return static_cast<int>(grid_.rows); }
  // Returns the level of the one block that holds the whole grid; level 0 are the cells.
  [[nodiscard]] int top() const { return static_cast<int>(level_.size()); }
  // Returns the range of heights of block (column >> (kBits level), row >> (kBits level)), level >=
  // 1.
  [[nodiscard]] HeightRange range(int level, int block_column, int block_row) const {
    const Level& of = level_[static_cast<std::size_t>(level - 1)];
    return of.range[static_cast<std::size_t>(block_row) * static_cast<std::size_t>(of.columns) +
                    static_cast<std::size_t>(block_column)];
  }
  // Returns an upper bound of the slopes of triangles in such a block, rise by way; level >= 1.
  [[nodiscard]] float steepest(int level, int block_column, int block_row) const {
    const Level& of = level_[static_cast<std::size_t>(level - 1)];
    return of.steepest[static_cast<std::size_t>(block_row) * static_cast<std::size_t>(of.columns) +
                       static_cast<std::size_t>(block_column)];
  }
  // Southwest corner of a cell; its north is columns() + 1 further.
  [[nodiscard]] const float* corner(int column, int row) const {
    return grid_.z_m.data() + static_cast<std::size_t>(row) * (grid_.columns + std::size_t{1}) +
           static_cast<std::size_t>(column);
  }
  // Widens the ranges of all blocks over these cells of this grid by the heights of a finer grid,
  // and their slopes by its slopes, of `fineness` cells for each of these, that replaces them.
  void cover(const CellBlock& cells, const HeightGrid& finer, int fineness);
  // Returns an upper bound of the heights in cells of a rectangle, which may reach beyond the grid.
  [[nodiscard]] float highest_m(const CellBlock& cells) const;
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  struct Level {
    int columns, rows;
    std::vector<HeightRange> range;
    std::vector<float> steepest;
  };
  void widen(int column, int row, HeightRange by, float steepest);

  HeightGrid grid_;
  std::vector<Level> level_;
};

}  // namespace irsig
