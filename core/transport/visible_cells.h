#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/scene/trace/target.h"

namespace irsig {

// A target's vertices on an image plane. [vertex]
struct PlaneVertices {
  std::vector<double> x_m, y_m;
  std::vector<double> depth_m;  // from the sensor, along the plane's normal
};

struct CellGrid {
  double x0_m = 0, y0_m = 0, cell_x_m = 0, cell_y_m = 0;
  int columns = 0, rows = 0;
  std::vector<std::uint8_t> hit;  // [column x rows + row]
  // Returns the area of the cells that are hit, on the image plane.
  [[nodiscard]] double area_m2() const;
};

// Finds the cells of the image plane in which some facets of a target can be seen past all others:
// the cells that they touch, less the cells that nearer facets cover completely. The rectangle
// shrinks onto the remaining cells and is cut again, `cells` along its long side, so that a hole
// which shows a thousandth of a hot part is aimed at as well as the part alone would be.
//
// Proven but for rounding: a covering facet is taken to be larger by 1e-7 of `size_m` all around, a
// tenth of the ray tracer's own error. A cell is kept wherever the proof takes too long (more than
// 256 facets over it), and wherever the facet lies less than 1e-5 of size_m behind another. Empty:
// nothing can be seen.
//   facets   not empty
//   size_m   the target's, on the image plane
[[nodiscard]] CellGrid visible_cells(const Target& target, const PlaneVertices& plane,
                                     std::span<const std::uint32_t> facets, double size_m,
                                     int cells);

}  // namespace irsig
