#include "view/pictures/stored_exr.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string>

namespace irsig {
namespace {

static_assert(std::endian::native == std::endian::little);  // as the file's numbers are

enum class Packing { kRunLengths, kZip };

std::uint64_t number_at(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint64_t out = 0;
  std::memcpy(&out, bytes.data() + at, size);
  return out;
}

// The header of an image of one pixel, as the encoder writes it: all headers are like it, except
// for the corners of their windows.
struct Header {
  std::string bytes;
  std::array<std::size_t, 2> corner;  // places of (width - 1, height - 1)
  Packing packing;
  std::size_t lines_of_block;

  Header(const std::string& file, Packing packed, std::size_t lines)
      : bytes(file.substr(0, file.size() - kBehind)), packing(packed), lines_of_block(lines) {
    const std::string_view type("Window\0box2i\0\x10\0\0\0", 17);
    std::size_t at = 0;
    for (std::size_t& place : corner) {
      at = bytes.find(type, at) + type.size();
      place = at + 8;
    }
  }

  [[nodiscard]] bool begins(std::string_view exr) const {
    if (exr.size() < bytes.size()) return false;
    std::string expected = bytes;
    for (const std::size_t place : corner)
      std::memcpy(expected.data() + place, exr.data() + corner[0], 8);
    return exr.starts_with(expected);
  }

 private:
  // A place (8), a line (4), a size (4) and a pixel that is not packed (4).
  static constexpr std::size_t kBehind = 20;
};

const std::array<Header, 2>& headers() {
  static const std::array<Header, 2> known = {
      Header(*encode_exr({1, 1, {0.0F}}), Packing::kRunLengths, 1),
      Header(*encode_error_exr({1, 1, {0.0F}}), Packing::kZip, 16)};
  return known;
}

// Returns whether `in` fills `out` exactly: (length - 1, byte) is a run, (-length, bytes) are other
// bytes.
bool unpack_runs(std::string_view in, std::string& out) {
  std::size_t filled = 0;
  while (!in.empty()) {
    const int head = static_cast<signed char>(in.front());
    in.remove_prefix(1);
    const auto length = static_cast<std::size_t>(head < 0 ? -head : head + 1);
    const std::size_t taken = head < 0 ? length : 1;
    if (length > out.size() - filled || taken > in.size()) return false;
    if (head < 0)
      std::memcpy(out.data() + filled, in.data(), length);
    else
      std::memset(out.data() + filled, in.front(), length);
    in.remove_prefix(taken);
    filled += length;
  }
  return filled == out.size();
}

bool unpack_zip(std::string_view in, std::string& out) {
  uLongf filled = out.size();
  uLong taken = in.size();
  return uncompress2(reinterpret_cast<Bytef*>(out.data()), &filled,
                     reinterpret_cast<const Bytef*>(in.data()), &taken) == Z_OK &&
         filled == out.size() && taken == in.size();
}

// The inverse of OpenEXR's preparation of a block of whole numbers of four bytes: differences are
// summed, and bytes of even and odd places are put back. Plain pointers: with checked indices it
// takes three times as long.
void undo_differences(const std::string& prepared, char* block) {
  const std::size_t half = prepared.size() / 2;
  const char* difference = prepared.data();
  auto sum = static_cast<unsigned char>(128);
  for (const std::size_t first : {0, 1})
    for (char* to = block + first; to < block + 2 * half; to += 2) {
      sum = static_cast<unsigned char>(sum + static_cast<unsigned char>(*difference++) - 128);
      *to = static_cast<char>(sum);
    }
}

}  // namespace

std::optional<RadianceImage> read_stored_exr(std::string_view exr, std::uint32_t most_px) {
  const auto header = std::find_if(headers().begin(), headers().end(),
                                   [&](const Header& one) { return one.begins(exr); });
  if (header == headers().end()) return std::nullopt;
  const std::uint64_t width = number_at(exr, header->corner[0], 4) + 1,
                      height = number_at(exr, header->corner[0] + 4, 4) + 1;
  if (width > most_px || height > most_px) return std::nullopt;
  const std::size_t of_block = header->lines_of_block;
  const std::size_t blocks = (height + of_block - 1) / of_block;
  std::size_t place = header->bytes.size(), at = place + 8 * blocks;
  if (at > exr.size()) return std::nullopt;
  RadianceImage out{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
  out.radiance_w_m2_sr.resize(width * height);
  char* pixels = reinterpret_cast<char*>(out.radiance_w_m2_sr.data());
  std::string prepared;
  for (std::size_t y = 0; y < height; y += of_block, place += 8) {
    if (exr.size() - at < 8 || number_at(exr, place, 8) != at || number_at(exr, at, 4) != y)
      return std::nullopt;
    const std::size_t size = number_at(exr, at + 4, 4);
    at += 8;
    if (size > exr.size() - at) return std::nullopt;
    const std::string_view packed = exr.substr(at, size);
    at += size;
    const std::size_t bytes = 4 * width * std::min<std::size_t>(of_block, height - y);
    char* block = pixels + 4 * width * y;
    if (size == bytes) {
      std::memcpy(block, packed.data(), bytes);
      continue;
    }
    prepared.resize(bytes);
    if (!(header->packing == Packing::kZip ? unpack_zip(packed, prepared)
                                           : unpack_runs(packed, prepared)))
      return std::nullopt;
    undo_differences(prepared, block);
  }
  if (at != exr.size()) return std::nullopt;
  return out;
}

}  // namespace irsig
