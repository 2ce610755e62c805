#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/store/tables/rows.h"

namespace irsig {

// A rectangle of an image: pixels x0 <= x < x1, y0 <= y < y1 from the top left corner.
struct ImageRectangle {
  std::string name;
  std::uint32_t x0_px, y0_px, x1_px, y1_px;
};

// Parses NAME=x0,y0,x1,y1 of each text. INVALID_ARGUMENT: another form, an empty rectangle, or a
// name twice.
[[nodiscard]] absl::StatusOr<std::vector<ImageRectangle>> parse_rectangles(
    std::span<const std::string> texts);

// Pixels of an image that are averaged, as places row by row from the top left.
struct ImageRegion {
  std::string name;
  std::vector<std::uint32_t> pixel;
};

// Returns the pixels of rectangles. INVALID_ARGUMENT: one reaches beyond the image.
[[nodiscard]] absl::StatusOr<std::vector<ImageRegion>> rectangle_regions(
    std::span<const ImageRectangle> rectangles, std::uint32_t width_px, std::uint32_t height_px);

// Returns the pixels of each part that has any in part_mask() (masks.h), and the whole image.
[[nodiscard]] std::vector<ImageRegion> part_regions(const StoredSilhouette& silhouette);

// Means over a region of an image. NaN: not known.
struct RegionMean {
  double radiance_w_m2_sr, stderr_w_m2_sr;
  double temperature_k;    // over the target's area in the region, and the land's, as far as known
  double target_fraction;  // of the region's area
  double known_fraction;   // of the region's area, with known temperature
};

// Pixels of an image and its layers, row by row from the top left.
struct ImageNumbers {
  std::span<const float> radiance_w_m2_sr;
  std::span<const float> stderr_w_m2_sr;  // empty: not known
  std::span<const float> temperature_k;   // of the target; empty: not known
  // Temperature of land beside and behind the target; 0: no land. Empty: not known.
  std::span<const float> land_temperature_k;
  std::span<const float> filled;  // the fraction of each pixel that the target fills
  // True if pixels without target have independent errors, as those of land of stated temperature,
  // which have their own rays. Pixels of sky and sea share a few directions, and computed
  // temperatures of land share their error.
  bool independent_background = false;
};

// Returns the means over a region of n pixels. The radiance is the mean with equal weights. The
// temperature is one mean over the target and the land: a pixel's temperature of the target has the
// filled fraction as its weight, its temperature of land the rest. The standard error takes the
// errors e of the target's pixels T as independent and those of the other pixels B as one common
// error:
//
//   stderr = sqrt(sum_T e^2 + (sum_B e)^2) / n
//
// and, with independent_background, sqrt(sum e^2) / n over all pixels.
[[nodiscard]] RegionMean region_mean(const ImageRegion& region, const ImageNumbers& image);

}  // namespace irsig
