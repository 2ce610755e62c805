#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "view/draw/false_color.h"

namespace irsig {

// One picture of a sheet. Values row by row from the top left; NaN: nothing is there.
struct SheetCell {
  std::uint32_t width_px = 0, height_px = 0;
  std::vector<float> value;
  std::string label;
};

// Returns the cells side by side, about 1.5 times as wide as high, each below its label: size,
// values and labels of a picture.
[[nodiscard]] FalseColorPicture lay_out_sheet(const std::vector<SheetCell>& cells);

}  // namespace irsig
