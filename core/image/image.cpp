#include "core/image/image.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/base/status_macros.h"

namespace irsig {
namespace {

absl::Status check_size(std::uint32_t width_px, std::uint32_t height_px, std::size_t pixels) {
  constexpr std::uint32_t max_px = 1u << 15;
  if (width_px == 0 || height_px == 0 || width_px > max_px || height_px > max_px)
    return absl::InvalidArgumentError("image: expected 1 to 32768 pixels in width and height");
  if (pixels != std::size_t{width_px} * height_px)
    return absl::InvalidArgumentError("image: the pixels do not fill width x height");
  return absl::OkStatus();
}

absl::Status check(const RadianceImage& image) {
  RETURN_IF_ERROR(check_size(image.width_px, image.height_px, image.radiance_w_m2_sr.size()));
  for (const float radiance : image.radiance_w_m2_sr) {
    if (!std::isfinite(radiance))
      return absl::InvalidArgumentError("image: a radiance is not finite");
  }
  return absl::OkStatus();
}

void append_little_endian(std::string& out, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<char>(value >> (8 * i) & 0xffU));
}

void append_big_endian(std::string& out, std::uint32_t value) {
  for (int i = 3; i >= 0; --i) out.push_back(static_cast<char>(value >> (8 * i) & 0xffU));
}

void append_attribute(std::string& out, std::string_view name, std::string_view type,
                      std::string_view value) {
  out.append(name).push_back('\0');
  out.append(type).push_back('\0');
  append_little_endian(out, value.size(), 4);
  out.append(value);
}

// The header of an EXR file of scan lines, its attributes in the order of their names.
enum class ExrPacking : char { kRunLengths = 1, kZip = 3 };  // OpenEXR's numbers

std::string exr_header(std::uint32_t width_px, std::uint32_t height_px, ExrPacking packing,
                       std::span<const std::string> names) {
  std::string channels, window(8, '\0'), one;
  for (const std::string& name : names) {
    channels.append(name).push_back('\0');
    append_little_endian(channels, 2, 4);  // float32
    append_little_endian(channels, 0, 4);  // not linear, reserved
    append_little_endian(channels, 1, 4);  // every column
    append_little_endian(channels, 1, 4);  // every line
  }
  channels.push_back('\0');
  append_little_endian(window, width_px - 1, 4);
  append_little_endian(window, height_px - 1, 4);
  append_little_endian(one, std::bit_cast<std::uint32_t>(1.0f), 4);
  std::string out;
  append_little_endian(out, 20000630, 4);  // the format's mark
  append_little_endian(out, 2, 4);         // its version
  append_attribute(out, "capDate", "string", "1970:01:01 00:00:00");
  append_attribute(out, "channels", "chlist", channels);
  append_attribute(out, "compression", "compression", std::string(1, static_cast<char>(packing)));
  append_attribute(out, "dataWindow", "box2i", window);
  append_attribute(out, "displayWindow", "box2i", window);
  append_attribute(out, "lineOrder", "lineOrder", std::string_view("\0", 1));
  append_attribute(out, "pixelAspectRatio", "float", one);
  append_attribute(out, "screenWindowCenter", "v2f", std::string(8, '\0'));
  append_attribute(out, "screenWindowWidth", "float", one);
  out.push_back('\0');
  return out;
}

// A run of 3 to 128 equal bytes becomes (length - 1, byte), 1 to 127 other bytes become (-length,
// bytes).
std::string run_lengths(std::string_view in) {
  constexpr std::size_t shortest = 3, longest = 127;
  std::string out;
  out.reserve(in.size() + in.size() / longest + 1);
  std::size_t begin = 0, end = 1;
  while (begin < in.size()) {
    while (end < in.size() && in[begin] == in[end] && end - begin <= longest) ++end;
    if (end - begin >= shortest) {
      out.push_back(static_cast<char>(end - begin - 1));
      out.push_back(in[begin]);
    } else {
      const auto run_begins = [&](std::size_t at) {
        return at + 2 < in.size() && in[at] == in[at + 1] && in[at + 1] == in[at + 2];
      };
      while (end < in.size() && !run_begins(end) && end - begin < longest) ++end;
      out.push_back(static_cast<char>(begin - end));
      out.append(in.substr(begin, end - begin));
    }
    begin = end++;
  }
  return out;
}

// A block of lines as OpenEXR prepares it: bytes at even places before those at odd places, each as
// its difference from the one before.
std::string exr_differences(std::string_view block) {
  std::string halves(block.size(), '\0');
  const std::size_t odd = (block.size() + 1) / 2;
  for (std::size_t i = 0; i < block.size(); ++i) halves[i / 2 + (i % 2) * odd] = block[i];
  for (std::size_t i = halves.size() - 1; i > 0; --i)
    halves[i] = static_cast<char>(halves[i] - halves[i - 1] + 128);
  return halves;
}

void append_chunk(std::string& out, std::string_view type, std::string_view data) {
  append_big_endian(out, static_cast<std::uint32_t>(data.size()));
  const std::size_t begin = out.size();
  out.append(type).append(data);
  append_big_endian(
      out, static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(out.data()) + begin,
                                            static_cast<uInt>(out.size() - begin))));
}

// PNG's filters, in the order of their numbers.
enum Filter : unsigned char { kNone, kSub, kUp, kAverage, kPaeth };

// Writes one line of grey under a filter to `out`, which has its size, and returns the sum of the
// magnitudes of its bytes as signed numbers. Plain pointers: with checked indices and a text that
// grows it takes three times as long.
template <Filter kFilter>
std::uint64_t filter_line(std::string_view line, std::string_view above, std::size_t pixel_bytes,
                          unsigned char* out) {
  const auto* now = reinterpret_cast<const unsigned char*>(line.data());
  const auto* before = reinterpret_cast<const unsigned char*>(above.data());
  std::uint32_t sum = 0;  // of at most 65536 bytes
  const auto put = [&](std::size_t x, int left, int up, int corner) {
    const int to_left = std::abs(up - corner), to_up = std::abs(left - corner);
    const int to_corner = std::abs(left + up - 2 * corner);
    const int paeth = to_left <= to_up && to_left <= to_corner ? left
                      : to_up <= to_corner                     ? up
                                                               : corner;
    const int predicted = kFilter == kSub       ? left
                          : kFilter == kUp      ? up
                          : kFilter == kAverage ? (left + up) / 2
                          : kFilter == kPaeth   ? paeth
                                                : 0;
    out[x] = static_cast<unsigned char>(now[x] - predicted);
    sum += static_cast<std::uint32_t>(std::abs(static_cast<signed char>(out[x])));
  };
  const std::size_t first = std::min(pixel_bytes, line.size());
  for (std::size_t x = 0; x < first; ++x) put(x, 0, before[x], 0);
  for (std::size_t x = first; x < line.size(); ++x)
    put(x, now[x - pixel_bytes], before[x], before[x - pixel_bytes]);
  return sum;
}

// Appends the number of a filter and the line under it: the filter under which the bytes of the
// line, as signed numbers, have the smallest sum of magnitudes, as the PNG specification
// recommends. Filters that look up or left do so only where there is something.
//   other  two texts of the line's size, of any content
void append_best_filtered(std::string& out, std::string_view line, std::string_view above,
                          bool one_line, std::size_t pixel_bytes,
                          std::array<std::string, 2>& other) {
  const bool one_column = line.size() == pixel_bytes;
  std::uint64_t smallest = std::numeric_limits<std::uint64_t>::max();
  unsigned char best = kNone;
  const auto attempt = [&]<Filter kFilter>() {
    const std::uint64_t sum = filter_line<kFilter>(
        line, above, pixel_bytes, reinterpret_cast<unsigned char*>(other[1].data()));
    if (sum >= smallest) return;
    smallest = sum;
    best = kFilter;
    other[0].swap(other[1]);
  };
  attempt.template operator()<kNone>();
  if (!one_column) attempt.template operator()<kSub>();
  if (!one_line) attempt.template operator()<kUp>();
  if (!one_column && !one_line) attempt.template operator()<kAverage>();
  if (!one_column && !one_line) attempt.template operator()<kPaeth>();
  out.push_back(static_cast<char>(best));
  out += other[0];
}

// Appends a line as its difference from the line above, which is 0 before the first.
//   filtered  a text of the line's size
void append_difference(std::string& out, std::string_view line, std::string_view above,
                       std::size_t pixel_bytes, std::string& filtered) {
  (void)filter_line<kUp>(line, above, pixel_bytes,
                         reinterpret_cast<unsigned char*>(filtered.data()));
  out.push_back(static_cast<char>(kUp));
  out += filtered;
}

// The smallest window of deflate, in bits, that reaches back over all of `bytes` and a match.
int window_bits(std::size_t bytes) {
  int bits = MAX_WBITS;
  while (bits > 8 && bytes + 262 <= std::size_t{1} << (bits - 1)) --bits;
  return bits;
}

// The header of a zlib stream of no more than 16 kB states the smallest window that its reader
// needs, as libpng has it.
void state_window(std::string& stream, std::size_t bytes) {
  unsigned info = static_cast<unsigned char>(stream[0]) >> 4U;
  while (info > 0 && bytes <= std::size_t{1} << (info + 7)) --info;
  const unsigned method = info << 4U | 8U;
  unsigned flags = static_cast<unsigned char>(stream[1]) & 0xe0U;
  flags += 31 - (method << 8U | flags) % 31;
  stream[0] = static_cast<char>(method);
  stream[1] = static_cast<char>(flags);
}

constexpr int kUsualLevel = 6, kFastLevel = 1;  // of zlib

absl::StatusOr<std::string> deflated(std::string_view bytes, int level = kUsualLevel) {
  const bool small = bytes.size() <= 16384;
  z_stream stream{};
  constexpr int memory = 8;
  if (deflateInit2(&stream, level, Z_DEFLATED, small ? window_bits(bytes.size()) : MAX_WBITS,
                   memory, Z_DEFAULT_STRATEGY) != Z_OK)
    return absl::ResourceExhaustedError("image: no memory to compress it");
  std::string out(deflateBound(&stream, bytes.size()), '\0');
  // zlib does not write to its input.
  stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int code = deflate(&stream, Z_FINISH);
  out.resize(out.size() - stream.avail_out);
  deflateEnd(&stream);
  if (code != Z_STREAM_END) return absl::InternalError("image: cannot be compressed");
  if (small) state_window(out, bytes.size());
  return out;
}

// Channels in the order of their names, each [height][width].
struct Channels {
  std::uint32_t width_px, height_px;
  std::vector<std::string> name;
  std::vector<std::span<const float>> value;
};

absl::StatusOr<std::string> encode_lines(const Channels& image, ExrPacking packing) {
  const std::size_t width = image.width_px, height = image.height_px;
  std::string out = exr_header(image.width_px, image.height_px, packing, image.name);
  const std::size_t of_block = packing == ExrPacking::kZip ? 16 : 1;
  const std::size_t blocks = (height + of_block - 1) / of_block, table = out.size();
  std::string offsets, packed_blocks;
  for (std::size_t y = 0; y < height; y += of_block) {
    append_little_endian(offsets, table + 8 * blocks + packed_blocks.size(), 8);
    static_assert(std::endian::native == std::endian::little);  // as the file's numbers are
    std::string block;
    for (std::size_t line = y; line < std::min(y + of_block, height); ++line)
      for (const std::span<const float> channel : image.value)
        block.append(reinterpret_cast<const char*>(channel.data() + line * width), 4 * width);
    std::string packed = exr_differences(block);
    if (packing == ExrPacking::kRunLengths) {
      packed = run_lengths(packed);
    } else {
      ASSIGN_OR_RETURN(packed, deflated(packed));
    }
    if (packed.size() >= block.size()) packed = std::move(block);
    append_little_endian(packed_blocks, y, 4);
    append_little_endian(packed_blocks, packed.size(), 4);
    packed_blocks += packed;
  }
  return out + offsets + packed_blocks;
}

absl::StatusOr<std::string> encode_lines(const RadianceImage& image, ExrPacking packing) {
  RETURN_IF_ERROR(check(image));
  return encode_lines({image.width_px, image.height_px, {"Y"}, {image.radiance_w_m2_sr}}, packing);
}

}  // namespace

absl::StatusOr<std::string> encode_exr(const RadianceImage& image) {
  return encode_lines(image, ExrPacking::kRunLengths);
}

absl::StatusOr<std::string> encode_error_exr(const RadianceImage& image) {
  RadianceImage rounded = image;
  for (float& e : rounded.radiance_w_m2_sr)
    e = std::bit_cast<float>((std::bit_cast<std::uint32_t>(e) + 0x7ffffU) & 0xfff80000U);
  return encode_lines(rounded, ExrPacking::kZip);
}

absl::StatusOr<std::string> encode_layers_exr(
    std::uint32_t width_px, std::uint32_t height_px,
    const std::map<std::string, std::vector<float>>& layers) {
  Channels image{width_px, height_px, {}, {}};
  for (const auto& [name, values] : layers) {
    RETURN_IF_ERROR(check_size(width_px, height_px, values.size()));
    image.name.push_back(name + ".Y");
    image.value.emplace_back(values);
  }
  if (layers.empty()) return absl::InvalidArgumentError("image: has no layers");
  return encode_lines(image, ExrPacking::kZip);
}

absl::StatusOr<std::string> encode_png(const RadianceImage& image) {
  RETURN_IF_ERROR(check(image));
  return encode_png(
      image, {0, *std::max_element(image.radiance_w_m2_sr.begin(), image.radiance_w_m2_sr.end())});
}

absl::StatusOr<std::string> encode_png(const RadianceImage& image, const GreyScale& scale, int bits,
                                       PngPacking packing) {
  RETURN_IF_ERROR(check(image));
  const double black = static_cast<double>(scale.black_w_m2_sr);
  const double range = static_cast<double>(scale.white_w_m2_sr) - black;
  const double white = bits == 16 ? 65535 : 255;
  std::vector<std::uint16_t> grey;
  grey.reserve(image.radiance_w_m2_sr.size());
  for (const float radiance : image.radiance_w_m2_sr) {
    const double part =
        range > 0 ? std::clamp((static_cast<double>(radiance) - black) / range, 0.0, 1.0) : 0;
    grey.push_back(static_cast<std::uint16_t>(std::lround(white * part)));
  }
  return encode_grey_png(image.width_px, image.height_px, grey, bits, packing);
}

absl::StatusOr<std::string> encode_grey_png(std::uint32_t width_px, std::uint32_t height_px,
                                            std::span<const std::uint16_t> values, int bits,
                                            PngPacking packing) {
  RETURN_IF_ERROR(check_size(width_px, height_px, values.size()));
  if (bits != 8 && bits != 16)
    return absl::InvalidArgumentError("image: expected 8 or 16 bits of grey");
  const std::size_t pixel_bytes = bits == 16 ? 2 : 1;
  std::string above(width_px * pixel_bytes, '\0'), line = above, lines;
  std::array<std::string, 2> other = {line, line};
  lines.reserve(height_px * (line.size() + 1));
  for (std::size_t y = 0; y < height_px; ++y) {
    for (std::size_t x = 0; x < width_px; ++x) {
      const std::uint16_t value = values[y * width_px + x];
      if (bits == 8 && value > 255)
        return absl::InvalidArgumentError("image: a number has more than 8 bits");
      if (bits == 16) line[2 * x] = static_cast<char>(value >> 8U);
      line[pixel_bytes * x + pixel_bytes - 1] = static_cast<char>(value & 255U);
    }
    if (packing == PngPacking::kFast)
      append_difference(lines, line, above, pixel_bytes, other[0]);
    else
      append_best_filtered(lines, line, above, height_px == 1, pixel_bytes, other);
    above.swap(line);
  }
  ASSIGN_OR_RETURN(const std::string stream,
                   deflated(lines, packing == PngPacking::kFast ? kFastLevel : kUsualLevel));
  std::string header;
  append_big_endian(header, width_px);
  append_big_endian(header, height_px);
  header.push_back(static_cast<char>(bits));  // of grey
  header.append("\0\0\0\0", 4);               // deflate, filters by line, not interlaced
  std::string out("\x89PNG\r\n\x1a\n", 8);
  append_chunk(out, "IHDR", header);
  append_chunk(out, "oFFs", std::string(9, '\0'));
  constexpr std::size_t piece = 8192;
  for (std::size_t begin = 0; begin < stream.size(); begin += piece)
    append_chunk(out, "IDAT", std::string_view(stream).substr(begin, piece));
  append_chunk(out, "IEND", "");
  return out;
}

}  // namespace irsig
