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

// width x height pixels, row by row from the top left, each an index into at most 256 colours; the
// pixels of `transparent` show what is behind them. PNG of colour type 3 with stored blocks: as
// large as its pixels, and no library is needed for it.
[[nodiscard]] std::string encode_palette_png(std::uint32_t width, std::uint32_t height,
                                             const std::vector<std::uint8_t>& pixel,
                                             const std::vector<Rgb>& palette,
                                             std::optional<std::uint8_t> transparent = {});

// Returns the defect of a PNG: its signature, its chunks or one of their checksums; empty: none.
// Pixels are not unpacked: a correct checksum is taken for correct pixels.
[[nodiscard]] std::string png_defect(std::string_view bytes);

}  // namespace irsig
