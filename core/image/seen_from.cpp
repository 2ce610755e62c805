#include <algorithm>

#include "core/image/image.h"

namespace irsig {

RadianceImage seen_from(const RadianceImage& image, const SeenFrom& there) {
  const std::uint32_t width = image.width_px, height = image.height_px;
  const auto on = [&](std::uint32_t x, std::uint32_t y) {
    return image.radiance_w_m2_sr[std::size_t{y} * width + x] != 0;
  };
  // Unsigned: one less than the first column is none.
  const auto inside = [&](std::uint32_t x, std::uint32_t y) {
    return x - 1 < width && x + 1 < width && y - 1 < height && y + 1 < height && on(x - 1, y) &&
           on(x + 1, y) && on(x, y - 1) && on(x, y + 1);
  };
  std::uint64_t within = 0, edge = 0;
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      if (on(x, y)) ++(inside(x, y) ? within : edge);
  const double of_edge = edge > 0
                             ? std::clamp((there.target_area_px - static_cast<double>(within)) /
                                              static_cast<double>(edge),
                                          0.0, 1.0)
                             : 0;
  RadianceImage out = image;
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const double share = !on(x, y) ? 0 : inside(x, y) ? 1 : of_edge;
      float& pixel = out.radiance_w_m2_sr[std::size_t{y} * width + x];
      pixel = static_cast<float>(share * there.path_radiance_w_m2_sr +
                                 there.gain * static_cast<double>(pixel) +
                                 (1 - share) * there.background_radiance_w_m2_sr);
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
