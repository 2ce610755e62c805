#include "view/draw/png.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "core/base/check.h"

namespace irsig {
namespace {

void put_u32(std::string& out, std::uint32_t value) {  // most significant byte first
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<char>(value >> shift));
}

// ISO 3309, as the PNG specification (ISO/IEC 15948, annex D) has it.
std::uint32_t crc32(std::string_view bytes) {
  static const auto kTable = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t n = 0; n < 256; ++n) {
      std::uint32_t c = n;
      for (int k = 0; k < 8; ++k) c = (c & 1) != 0 ? 0xEDB88320U ^ (c >> 1) : c >> 1;
      table[n] = c;
    }
    return table;
  }();
  std::uint32_t c = 0xFFFFFFFFU;
  for (const char byte : bytes) c = kTable[(c ^ static_cast<std::uint8_t>(byte)) & 0xFF] ^ (c >> 8);
  return ~c;
}

std::uint32_t adler32(std::string_view bytes) {  // RFC 1950
  std::uint32_t a = 1, b = 0;
  for (const char byte : bytes) {
    a = (a + static_cast<std::uint8_t>(byte)) % 65521;
    b = (b + a) % 65521;
  }
  return b << 16 | a;
}

void put_chunk(std::string& out, const std::string& type_and_data) {
  put_u32(out, static_cast<std::uint32_t>(type_and_data.size() - 4));
  out += type_and_data;
  put_u32(out, crc32(type_and_data));
}

// A zlib stream of blocks that are not compressed (RFC 1951, 3.2.4).
std::string stored_block(std::string_view bytes) {
  std::string out("\x78\x01", 2);
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t size = std::min<std::size_t>(bytes.size() - at, 65535);
    out.push_back(at + size == bytes.size() ? '\1' : '\0');
    for (const std::size_t field : {size, ~size}) {
      out.push_back(static_cast<char>(field));
      out.push_back(static_cast<char>(field >> 8));
    }
    out += bytes.substr(at, size);
    at += size;
  }
  put_u32(out, adler32(bytes));
  return out;
}

std::uint32_t u32_at(std::string_view bytes, std::size_t at) {
  std::uint32_t out = 0;
  for (std::size_t i = 0; i < 4; ++i) out = out << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return out;
}

constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n", 8);

}  // namespace

std::string png_defect(std::string_view bytes) {
  if (!bytes.starts_with(kSignature)) return "it does not begin as a PNG";
  bool first = true, pixels = false;
  for (std::size_t at = kSignature.size();;) {
    if (bytes.size() - at < 12) return "it ends before its last chunk";
    const std::size_t size = u32_at(bytes, at);
    if (bytes.size() - at - 12 < size) return "a chunk is longer than what is there";
    const std::string_view type_and_data = bytes.substr(at + 4, size + 4);
    const std::string_view type = type_and_data.substr(0, 4);
    if (u32_at(bytes, at + 8 + size) != crc32(type_and_data)) return "a checksum does not match";
    if (first != (type == "IHDR")) return "its header is not its first chunk";
    first = false;
    pixels |= type == "IDAT";
    at += 12 + size;
    if (type != "IEND") continue;
    if (!pixels) return "it holds no pixels";
    return at == bytes.size() ? "" : "bytes follow after its end";
  }
}

std::string encode_palette_png(std::uint32_t width, std::uint32_t height,
                               const std::vector<std::uint8_t>& pixel,
                               const std::vector<Rgb>& palette,
                               std::optional<std::uint8_t> transparent) {
  IRSIG_CHECK(pixel.size() == static_cast<std::size_t>(width) * height);
  std::string out("\x89PNG\r\n\x1a\n", 8), header = "IHDR", colors = "PLTE", rows;
  put_u32(header, width);
  put_u32(header, height);
  header += std::string("\x08\x03\0\0\0", 5);  // 8 bit, palette, no interlace
  for (const Rgb& c : palette)
    for (const std::uint8_t channel : {c.red, c.green, c.blue})
      colors.push_back(static_cast<char>(channel));
  for (std::uint32_t y = 0; y < height; ++y) {
    rows.push_back('\0');  // no filter
    const auto row = pixel.begin() + static_cast<std::ptrdiff_t>(y) * width;
    rows.append(row, row + width);
  }
  put_chunk(out, header);
  put_chunk(out, colors);
  if (transparent) put_chunk(out, "tRNS" + std::string(*transparent, '\xff') + '\0');
  put_chunk(out, "IDAT" + stored_block(rows));
  put_chunk(out, "IEND");
  return out;
}

}  // namespace irsig
