#include "view/pictures/tiff.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

namespace irsig {
namespace {

static_assert(std::endian::native == std::endian::little);  // as the file's numbers are

template <typename T>
void append_number(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// TIFF 6.0, section 2: types of fields.
enum class Type : std::uint16_t { kText = 2, kShort = 3, kLong = 4, kRational = 5 };

struct Field {
  std::uint16_t tag;
  Type type;
  std::uint32_t count, value;  // the place of the value where it has more than 4 bytes
};

std::string strip_of(const RadianceImage& image, const GreyScale& scale, int bits) {
  std::string out;
  out.reserve(image.radiance_w_m2_sr.size() * static_cast<std::size_t>(bits / 8));
  const double black = static_cast<double>(scale.black_w_m2_sr);
  const double range = static_cast<double>(scale.white_w_m2_sr) - black;
  const double white = bits == 16 ? 65535 : 255;
  for (const float radiance : image.radiance_w_m2_sr) {
    const double part =
        range > 0 ? std::clamp((static_cast<double>(radiance) - black) / range, 0.0, 1.0) : 0;
    if (bits == 32)
      append_number(out, radiance);
    else if (bits == 16)
      append_number(out, static_cast<std::uint16_t>(std::lround(white * part)));
    else
      append_number(out, static_cast<std::uint8_t>(std::lround(white * part)));
  }
  return out;
}

}  // namespace

absl::StatusOr<std::string> encode_tiff(const RadianceImage& image, const GreyScale& scale,
                                        int bits) {
  if (bits != 8 && bits != 16 && bits != 32)
    return absl::InvalidArgumentError("image: expected 8, 16 or 32 bits");
  if (image.radiance_w_m2_sr.empty() ||
      image.radiance_w_m2_sr.size() != std::size_t{image.width_px} * image.height_px)
    return absl::InvalidArgumentError("image: the pixels do not fill width x height");
  for (const float radiance : image.radiance_w_m2_sr)
    if (!std::isfinite(radiance))
      return absl::InvalidArgumentError("image: a radiance is not finite");
  constexpr std::uint32_t kHeader = 8;
  const std::string pixels = strip_of(image, scale, bits);
  std::string text =
      bits == 32 ? std::string("in-band radiance, W/(m2 sr)")
                 : fmt::format("in-band radiance, W/(m2 sr): 0 is {}, {} is {}",
                               scale.black_w_m2_sr, bits == 16 ? 65535 : 255, scale.white_w_m2_sr);
  text.push_back('\0');
  if ((pixels.size() + text.size()) % 2 != 0) text.push_back('\0');  // numbers at even places
  const auto size = static_cast<std::uint32_t>(pixels.size());
  const auto letters = static_cast<std::uint32_t>(text.size());
  const std::uint32_t one_to_one = kHeader + size + letters, fields_at = one_to_one + 8;
  const std::vector<Field> fields = {
      {256, Type::kLong, 1, image.width_px},
      {257, Type::kLong, 1, image.height_px},
      {258, Type::kShort, 1, static_cast<std::uint32_t>(bits)},
      {259, Type::kShort, 1, 1},  // not compressed
      {262, Type::kShort, 1, 1},  // 0 is black
      {270, Type::kText, letters, kHeader + size},
      {273, Type::kLong, 1, kHeader},  // where the strip is
      {277, Type::kShort, 1, 1},       // one channel
      {278, Type::kLong, 1, image.height_px},
      {279, Type::kLong, 1, size},
      {282, Type::kRational, 1, one_to_one},  // square pixels of no stated size
      {283, Type::kRational, 1, one_to_one},
      {296, Type::kShort, 1, 1},
      {339, Type::kShort, 1, bits == 32 ? 3U : 1U}};  // IEEE numbers, or whole ones
  std::string out("II*\0", 4);
  append_number(out, fields_at);
  out += pixels;
  out += text;
  append_number(out, std::uint32_t{1});
  append_number(out, std::uint32_t{1});
  append_number(out, static_cast<std::uint16_t>(fields.size()));
  for (const Field& field : fields) {
    append_number(out, field.tag);
    append_number(out, static_cast<std::uint16_t>(field.type));
    append_number(out, field.count);
    append_number(out, field.value);  // a short one stands in the first two bytes
  }
  append_number(out, std::uint32_t{0});  // no further image
  return out;
}

}  // namespace irsig
