#pragma once

#include "core/clutter/lag_sums.h"

namespace irsig {

// Means over all squares of a side inside the grid, one at each pixel where a square can begin. A
// side that is no whole number takes a fraction of its last pixels. side_px: at least 1, at most
// the grid's shorter side.
[[nodiscard]] PixelGrid patch_means(const PixelGrid& grid, double side_px);

}  // namespace irsig
