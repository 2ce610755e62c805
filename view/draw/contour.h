#pragma once

#include <cstddef>
#include <vector>

#include "view/draw/svg.h"

namespace irsig {

// Values at the nodes of a regular grid, row by row.
struct ValueGrid {
  std::size_t columns, rows;
  Point corner;  // pixel of node (0, 0)
  double step;   // pixels between nodes
  std::vector<double> value;
};

// Returns the closed outlines [px] of the region where the grid is >= level. Values are linear
// between the nodes, and the grid's edge closes the outlines. The even-odd rule fills the region.
[[nodiscard]] std::vector<std::vector<Point>> outlines(const ValueGrid& grid, double level);

}  // namespace irsig
