#include "view/pictures/sheet_layout.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace irsig {

FalseColorPicture lay_out_sheet(const std::vector<SheetCell>& cells) {
  std::uint32_t width = 0, height = 0;
  for (const SheetCell& cell : cells) {
    width = std::max(width, cell.width_px);
    height = std::max(height, cell.height_px);
  }
  const std::uint32_t label_px = std::max(8u, width / 6), gap_px = std::max(2u, width / 30);
  const std::uint32_t cell_x = width + gap_px, cell_y = height + label_px;
  const auto count = static_cast<std::uint32_t>(cells.size());
  const auto columns = std::clamp(
      static_cast<std::uint32_t>(std::lround(std::sqrt(1.5 * count * cell_y / cell_x))), 1u, count);
  FalseColorPicture out;
  out.width_px = columns * cell_x;
  out.height_px = (count + columns - 1) / columns * cell_y;
  out.value.assign(std::size_t{out.width_px} * out.height_px,
                   std::numeric_limits<float>::quiet_NaN());
  for (std::uint32_t i = 0; i < count; ++i) {
    const SheetCell& cell = cells[i];
    const std::uint32_t left = i % columns * cell_x, top = i / columns * cell_y + label_px;
    for (std::uint32_t y = 0; y < cell.height_px; ++y)
      std::copy_n(cell.value.begin() + std::ptrdiff_t{y} * cell.width_px, cell.width_px,
                  out.value.begin() + (std::ptrdiff_t{top} + y) * out.width_px + left);
    out.label.push_back({static_cast<double>(left), top - 0.25 * label_px, cell.label});
  }
  return out;
}

}  // namespace irsig
