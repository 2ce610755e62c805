#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/transport/traced_pictures.h"

namespace irsig {

// One picture: [pixel] radiance x solid angle x range^2 [W/sr], and the variance of it.
struct PixelSums {
  std::vector<double> w_sr, variance;
};

// Adds to the variances of a part of a picture what the samples of a pixel may not have met of its
// neighbours' light (below), where that part has fewer samples than the rest.
void add_unmet(std::uint32_t width_px, std::uint32_t height_px, std::uint32_t samples,
               PixelSums& part);

// Standard errors of the pixels of a view's pictures. The variance of a pixel is that of its few
// groups of samples (pixel_groups), in mean over it and those of its eight neighbours that the
// target fills as it does: wholly, in part or not at all. To it is added what no sample of a pixel
// may have met of what a neighbour shows: an edge that runs close to the border of two pixels of n
// samples leaves up to 1 / n of one unmet, and does so in 1 / n of all cases, so that the error is
// about n^-1.5 times the difference of the two. Sums of float32 numbers are known to 5e-7.
class PixelErrors {
 public:
  //   samples  of each pixel
  //   met      which of them met a part of the target, by pixel
  PixelErrors(std::uint32_t width_px, std::uint32_t height_px, std::uint32_t samples,
              std::span<const TracedPictures::Met> met);

  // Returns the errors of a picture's pixels. [pixel] [W/sr]
  [[nodiscard]] std::vector<double> of(const PixelSums& picture) const;

 private:
  std::uint32_t width_px_, height_px_, samples_;
  enum class Filled : std::uint8_t { kNone, kInPart, kWhole };
  std::vector<Filled> filled_;  // [pixel]
};

}  // namespace irsig
