#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "live/page/fly_page.h"

namespace irsig {

std::uint16_t half_of(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const std::uint32_t sign = (bits >> 16) & 0x8000u, magnitude = bits & 0x7fffffffu;
  if (magnitude >= 0x7f800000u)
    return static_cast<std::uint16_t>(sign | (magnitude > 0x7f800000u ? 0x7e00u : 0x7c00u));
  if (magnitude >= 0x477ff000u) return static_cast<std::uint16_t>(sign | 0x7c00u);
  if (magnitude < 0x38800000u) {  // subnormal: a float of that size, rounded to steps of 2^-24
    const float steps = std::bit_cast<float>(magnitude) * 0x1p24f;
    return static_cast<std::uint16_t>(sign | static_cast<std::uint32_t>(std::nearbyint(steps)));
  }
  const std::uint32_t rounded = magnitude + 0xfffu + ((magnitude >> 13) & 1u);
  return static_cast<std::uint16_t>(sign | ((rounded - 0x38000000u) >> 13));
}

std::uint8_t encoded_error(double relative, bool edge) {
  if (edge || !std::isfinite(relative)) return 255;
  const double step = std::ceil(254.0 / 4 * std::log10(std::max(relative, 1e-4) / 1e-4));
  return static_cast<std::uint8_t>(std::clamp(step, 0.0, 254.0));
}

std::string encode_picture(const LivePicture& picture) {
  const LiveFrame& f = picture.frame;
  const std::size_t pixels = f.radiance_w_m2_sr.size();
  float low = INFINITY, high = 0;
  std::size_t edges = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    low = std::min(low, f.radiance_w_m2_sr[i]);
    high = std::max(high, f.radiance_w_m2_sr[i]);
    edges += f.edge[i];
  }
  // A power of two, so that the scale changes no bit of a radiance: the brightest is below 2^15.
  const float scale = high > 0 ? std::ldexp(1.0f, std::ilogb(high) - 14) : 1.0f;
  std::string out(64 + 3 * pixels, '\0');
  const auto put = [&out](std::size_t at, auto value) {
    std::memcpy(out.data() + at, &value, sizeof value);
  };
  std::memcpy(out.data(), "IRFL", 4);
  put(4, f.width_px);
  put(8, f.height_px);
  put(12, static_cast<std::uint32_t>(picture.state));
  put(16, scale);
  put(20, static_cast<float>(1e3 * f.seconds));
  put(24, low);
  put(28, high);
  put(32, pixels > 0 ? static_cast<float>(edges) / static_cast<float>(pixels) : 0.0f);
  put(36, static_cast<float>(f.counts_per_w_m2_sr));
  put(40, static_cast<float>(f.offset_counts));
  for (std::size_t i = 0; i < pixels; ++i) {
    const float radiance = f.radiance_w_m2_sr[i];
    put(64 + 2 * i, half_of(radiance / scale));
    const double relative = radiance > 0 ? static_cast<double>(f.error[i] / radiance) : 1.0;
    out[64 + 2 * pixels + i] = static_cast<char>(encoded_error(relative, f.edge[i] != 0));
  }
  return out;
}

}  // namespace irsig
