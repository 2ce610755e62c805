#include <algorithm>

#include "core/image/image.h"

namespace irsig {

absl::StatusOr<RadianceImage> seen_from(const RadianceImage& image, const SeenFrom& there) {
  if (there.filled.size() != image.radiance_w_m2_sr.size())
    return absl::InvalidArgumentError("image: its silhouette is of another size");
  RadianceImage out = image;
  for (std::size_t i = 0; i < out.radiance_w_m2_sr.size(); ++i) {
    const auto filled = static_cast<double>(there.filled[i]);
    float& pixel = out.radiance_w_m2_sr[i];
    pixel = static_cast<float>(filled * there.path_radiance_w_m2_sr +
                               there.gain * static_cast<double>(pixel) +
                               (1 - filled) * there.background_radiance_w_m2_sr);
  }
  return out;
}

ImageContent content_of(const RadianceImage& image) {
  ImageContent out;
  std::uint32_t right = 0, bottom = 0;
  for (std::uint32_t y = 0; y < image.height_px; ++y)
    for (std::uint32_t x = 0; x < image.width_px; ++x) {
      const float radiance = image.radiance_w_m2_sr[std::size_t{y} * image.width_px + x];
      if (radiance == 0) continue;
      if (out.shown_px++ == 0) {
        out.left_px = right = x;
        out.top_px = y;
        out.hottest_w_m2_sr = radiance;
      }
      out.hottest_w_m2_sr = std::max(out.hottest_w_m2_sr, radiance);
      out.left_px = std::min(out.left_px, x);
      right = std::max(right, x);
      bottom = y;
    }
  if (out.shown_px == 0) return out;
  out.width_px = right - out.left_px + 1;
  out.height_px = bottom - out.top_px + 1;
  return out;
}

}  // namespace irsig
