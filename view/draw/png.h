#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace irsig {

struct Rgb {
  std::uint8_t red, green, blue;
};

// Encodes width x height pixels as a PNG of colour type 3. Pixels are row by row from the top left;
// each is an index into at most 256 colours. Pixels of the colour `transparent` are transparent.
// Blocks are stored without compression, so that no library is needed.
[[nodiscard]] std::string encode_palette_png(std::uint32_t width, std::uint32_t height,
                                             const std::vector<std::uint8_t>& pixel,
                                             const std::vector<Rgb>& palette,
                                             std::optional<std::uint8_t> transparent = {});

// Returns the defect of a PNG: its signature, its chunks or one of their checksums; empty: none.
// Pixels are not unpacked: a correct checksum is taken for correct pixels.
[[nodiscard]] std::string png_defect(std::string_view bytes);

}  // namespace irsig
