#include "live/film.h"

#include <array>
#include <string_view>

#include "core/base/status_macros.h"

namespace irsig {
namespace {

constexpr std::string_view kPngMark("\x89PNG\r\n\x1a\n", 8);

std::uint32_t number_at(std::string_view bytes, std::size_t at) {
  std::uint32_t out = 0;
  for (std::size_t k = 0; k < 4; ++k) out = out << 8 | static_cast<std::uint8_t>(bytes[at + k]);
  return out;
}
void put_number(std::uint32_t value, std::size_t bytes, std::string& to) {
  for (std::size_t k = bytes; k-- > 0;) to.push_back(static_cast<char>(value >> (8 * k) & 0xff));
}

// CRC-32 of the PNG specification, annex D.
std::uint32_t crc_of(std::string_view bytes) {
  static const auto table = [] {
    std::array<std::uint32_t, 256> out{};
    for (std::uint32_t n = 0; n < 256; ++n) {
      std::uint32_t c = n;
      for (int k = 0; k < 8; ++k) c = (c & 1) != 0 ? 0xedb88320u ^ (c >> 1) : c >> 1;
      out[n] = c;
    }
    return out;
  }();
  std::uint32_t c = 0xffffffffu;
  for (const char byte : bytes) c = table[(c ^ static_cast<std::uint8_t>(byte)) & 0xff] ^ (c >> 8);
  return c ^ 0xffffffffu;
}

void put_chunk(std::string_view type, std::string_view content, std::string& to) {
  put_number(static_cast<std::uint32_t>(content.size()), 4, to);
  const std::string whole = std::string(type) + std::string(content);
  to += whole;
  put_number(crc_of(whole), 4, to);
}

struct Still {
  std::string head;  // content of IHDR
  std::string data;  // of all IDAT
};

absl::StatusOr<Still> still_of(std::string_view png) {
  if (!png.starts_with(kPngMark))
    return absl::InvalidArgumentError("a picture of the film is no PNG");
  Still out;
  for (std::size_t at = kPngMark.size(); at + 12 <= png.size();) {
    const std::size_t size = number_at(png, at);
    if (size > png.size() - at - 12)
      return absl::InvalidArgumentError("a picture of the film is cut off");
    const std::string_view type = png.substr(at + 4, 4), content = png.substr(at + 8, size);
    if (type == "IHDR") out.head = content;
    if (type == "IDAT") out.data += content;
    at += 12 + size;
  }
  if (out.head.size() != 13 || out.data.empty())
    return absl::InvalidArgumentError("a picture of the film has no pixels");
  return out;
}

}  // namespace

absl::StatusOr<std::string> animated_png(const std::vector<std::string>& still,
                                         std::uint16_t pause_ms) {
  if (still.empty()) return absl::InvalidArgumentError("a film has at least one picture");
  std::string out(kPngMark), head;
  std::uint32_t order = 0;
  for (std::size_t i = 0; i < still.size(); ++i) {
    ASSIGN_OR_RETURN(const Still frame, still_of(still[i]));
    if (i == 0) {
      head = frame.head;
      put_chunk("IHDR", head, out);
      std::string control;
      put_number(static_cast<std::uint32_t>(still.size()), 4, control);
      put_number(0, 4, control);  // repeated for ever
      put_chunk("acTL", control, out);
    }
    if (frame.head != head)
      return absl::InvalidArgumentError("the pictures of a film have the same size and kind");
    std::string control;
    put_number(order++, 4, control);
    control += frame.head.substr(0, 8);  // width, height
    put_number(0, 8, control);           // x and y of its corner
    put_number(pause_ms, 2, control);
    put_number(1000, 2, control);
    put_number(0, 2, control);  // replaces what was there
    put_chunk("fcTL", control, out);
    if (i == 0) {
      put_chunk("IDAT", frame.data, out);
      continue;
    }
    std::string data;
    put_number(order++, 4, data);
    put_chunk("fdAT", data + frame.data, out);
  }
  put_chunk("IEND", "", out);
  return out;
}

}  // namespace irsig
