#pragma once

#include <cstddef>
#include <vector>

namespace irsig {

// Pixels of the background around a target, as the sensor sees it with the target removed. A
// pixel's radiance is linear in the sources: sum over sources of weight x the source's radiance. A
// field is traced once for a view, and evaluated for many conditions and bands.
struct ClutterField {
  std::size_t columns = 0, rows = 0;  // at least 1 each
  double pixel_m = 0;                 // side of a pixel at the target's range; > 0
  std::size_t sources = 0;
  std::vector<float> weight;  // [pixel][source], pixels row by row from the top; finite

  [[nodiscard]] std::size_t pixels() const { return columns * rows; }
};

// Returns the side of the squares over which the background is averaged, in pixels: that of a
// square of the target's projected area, but at least a pixel, and at most half of the window's
// shorter side.
[[nodiscard]] double patch_px(const ClutterField& field, double target_area_m2);

}  // namespace irsig
