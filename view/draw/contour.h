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

// The closed outlines, in pixels, of the region where the grid (linear between its nodes) is >=
// level; the grid's edge closes them. Filled with the even-odd rule they are that region.
[[nodiscard]] std::vector<std::vector<Point>> outlines(const ValueGrid& grid, double level);

}  // namespace irsig
