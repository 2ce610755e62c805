#pragma once

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "schema/result.pb.h"

namespace irsig {

// Pictures of noise, as a worker's are laid out, without the library that makes those.

inline std::string noise(std::mt19937_64& random, std::size_t size) {
  std::string bytes(size, '\0');
  for (char& c : bytes) c = static_cast<char>(random());
  return bytes;
}

inline std::string big_endian_text(std::uint32_t value) {
  std::string out;
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(value >> shift & 0xffU);
  return out;
}
inline std::string little_endian_text(std::uint32_t value) {
  const std::string reversed = big_endian_text(value);
  return {reversed.rbegin(), reversed.rend()};
}

inline std::string png_chunk(const std::string& name_and_body) {
  const uLong sum = crc32(0, reinterpret_cast<const Bytef*>(name_and_body.data()),
                          static_cast<uInt>(name_and_body.size()));
  return big_endian_text(static_cast<std::uint32_t>(name_and_body.size() - 4)) + name_and_body +
         big_endian_text(static_cast<std::uint32_t>(sum));
}

// 8 bit grey; `rows`: for each row a filter byte (0) and its pixels.
inline std::string png_of(std::uint32_t width_px, std::uint32_t height_px,
                          const std::string& rows) {
  uLongf size = compressBound(rows.size());
  std::string packed(size, '\0');
  compress(reinterpret_cast<Bytef*>(packed.data()), &size,
           reinterpret_cast<const Bytef*>(rows.data()), rows.size());
  packed.resize(size);
  return "\x89PNG\r\n\x1a\n" +
         png_chunk("IHDR" + big_endian_text(width_px) + big_endian_text(height_px) +
                   std::string("\x08\0\0\0\0", 5)) +
         png_chunk("IDAT" + packed) + png_chunk("IEND");
}

inline std::string synthetic_png(std::uint32_t width_px, std::uint32_t height_px,
                                 std::mt19937_64& random) {
  std::string rows;
  for (std::uint32_t y = 0; y < height_px; ++y) rows += '\0' + noise(random, width_px);
  return png_of(width_px, height_px, rows);
}

// A header and rows, in all so many bytes of noise.
inline std::string synthetic_exr(std::uint32_t width_px, std::uint32_t height_px, std::size_t bytes,
                                 std::mt19937_64& random) {
  const auto text = [](std::string_view t) { return std::string(t) + '\0'; };
  const std::string window = little_endian_text(0) + little_endian_text(0) +
                             little_endian_text(width_px - 1) + little_endian_text(height_px - 1);
  std::string out = little_endian_text(20000630) + little_endian_text(2) + text("channels") +
                    text("chlist") + little_endian_text(19) + text("Y") + little_endian_text(2) +
                    std::string(12, '\1') + '\0' + text("dataWindow") + text("box2i") +
                    little_endian_text(16) + window + '\0';
  const auto of_row = [&](std::uint32_t y) {
    return bytes * (y + 1) / height_px - bytes * y / height_px;
  };
  std::size_t at = out.size() + 8 * std::size_t{height_px};
  for (std::uint32_t y = 0; y < height_px; ++y) {
    out += little_endian_text(static_cast<std::uint32_t>(at)) + little_endian_text(0);
    at += 8 + of_row(y);
  }
  for (std::uint32_t y = 0; y < height_px; ++y)
    out += little_endian_text(y) + little_endian_text(static_cast<std::uint32_t>(of_row(y))) +
           noise(random, of_row(y));
  return out;
}

// As schema::PartPixels has them.
inline std::string packed_counts(const std::vector<std::uint16_t>& counts) {
  std::string bytes;
  for (const std::uint16_t count : counts) {
    bytes += static_cast<char>(count & 255U);
    bytes += static_cast<char>(count >> 8U);
  }
  uLongf size = compressBound(bytes.size());
  std::string packed(size, '\0');
  compress(reinterpret_cast<Bytef*>(packed.data()), &size,
           reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  packed.resize(size);
  return packed;
}

// Rays that meet these parts: pixels skipped before each, and counts.
inline void add_part_set(const std::vector<std::uint32_t>& parts,
                         const std::vector<std::uint32_t>& skipped,
                         const std::vector<std::uint16_t>& counts, schema::Silhouette& out) {
  schema::PartSetPixels& set = *out.add_part_set();
  set.mutable_part_index()->Assign(parts.begin(), parts.end());
  set.set_outside_px(1.5);
  std::vector<std::uint16_t> halves;
  for (const std::uint32_t skip : skipped)
    halves.insert(halves.end(), {static_cast<std::uint16_t>(skip & 0xffffU),
                                 static_cast<std::uint16_t>(skip >> 16U)});
  halves.insert(halves.end(), counts.begin(), counts.end());
  set.set_samples(packed_counts(halves));
}

// Each part in a box of its own, of counts that fit 8 samples of a pixel.
inline void add_synthetic_silhouette(std::uint32_t width_px, std::uint32_t height_px, int parts,
                                     std::mt19937_64& random, schema::ViewJobResult& view) {
  schema::Silhouette& out = *view.mutable_silhouette();
  out.set_width_px(width_px);
  out.set_height_px(height_px);
  out.set_pixel_samples(8);
  for (int p = 0; p < std::min(parts, static_cast<int>(height_px)); ++p) {
    schema::PartPixels& part = *out.add_part();
    part.set_part_index(static_cast<std::uint32_t>(p));
    part.set_left_px(1);
    part.set_top_px(static_cast<std::uint32_t>(p));
    part.set_width_px(width_px - 1);
    part.set_height_px(1);
    std::vector<std::uint16_t> counts;
    for (std::uint32_t x = 1; x < width_px; ++x)
      counts.push_back(static_cast<std::uint16_t>(random() % 9));
    counts[0] = 8;
    part.set_samples(packed_counts(counts));
  }
  // Pixels 0 and 2 show the first part alone, 0 and 5 the second one behind it.
  add_part_set({0}, {0, 1}, {3, 8}, out);
  if (parts > 1) add_part_set({0, 1}, {0, 4}, {5, 1}, out);
}

}  // namespace irsig
