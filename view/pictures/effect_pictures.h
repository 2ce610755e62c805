#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/store/reader.h"
#include "view/draw/false_color.h"
#include "view/pictures/thumbnail.h"
#include "view/query/query.h"

namespace irsig {

// One image with and without effects on light: (a) emission without air, (b) emission behind air,
// (c) b and reflected light of the sky, (d) b and reflected light of the sun, (e) all. e = c + d -
// b. Sky beside land is as the sensor sees it in each picture. Light of surface and parts that the
// target reflects is in b.
struct EffectPictures {
  static constexpr std::array<const char*, 5> kName = {"a: emission, without air",
                                                       "b: emission, air", "c: b and sky reflected",
                                                       "d: b and sun reflected", "e: all"};
  StoredSignature row;
  std::uint32_t width_px = 0, height_px = 0;
  // [picture][pixel], row by row from the top left. [W/(m2 sr)]
  std::array<std::vector<float>, 5> w_m2_sr;
};

// Returns the pictures of the only row that a query selects (an aspect alone: the nearest
// viewpoint). Errors: those of run_query and stored_thumbnail; NOT_FOUND: a layer is not stored.
[[nodiscard]] absl::StatusOr<EffectPictures> effect_pictures(StoreReader& reader,
                                                             const Query& query,
                                                             const ReadPictures& read);

// Draws the five pictures on one scale, by default that of all their pixels.
[[nodiscard]] absl::StatusOr<FalseColorPicture> effects_sheet(
    const EffectPictures& pictures, const std::optional<ColorRange>& range);

// Draws the radiances of the five along the diagonal from the top left to the bottom right corner.
// A complete SVG document.
[[nodiscard]] std::string plot_diagonal(const EffectPictures& pictures);

// Writes the numbers of plot_diagonal(), a line for each place, in a format of table.h.
[[nodiscard]] absl::Status write_diagonal(const EffectPictures& pictures, std::string_view format,
                                          std::ostream& out);

}  // namespace irsig
