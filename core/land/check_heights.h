#pragma once

#include <cstdint>

#include "core/land/height_raster.h"

namespace irsig {

// Samples of one kind, and the first of them: column and row counted from 0, as in the file.
struct OddSamples {
  std::uint64_t count = 0;
  std::uint32_t column = 0, row = 0;
  double height_m = 0;
};

// Properties of a raster that hint at a damaged or misread map.
struct HeightReport {
  double spacing_m = 0;
  double lowest_m = 0, highest_m = 0;  // of samples with a height; 0: there is none
  OddSamples missing;
  // Samples above or below all of their neighbours by more than 2 samples' distance and 30 m: a
  // slope of 63 degrees to every side. Towers and trees in a model of the surface are lower.
  OddSamples spikes;
  // No land is higher than 8849 m or lower than -440 m. Heights in feet are above these limits in
  // mountains.
  bool beyond_land = false;
};

// Requires columns rows heights.
[[nodiscard]] HeightReport check_heights(const HeightRaster& raster);

}  // namespace irsig
