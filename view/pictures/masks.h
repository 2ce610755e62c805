#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "schema/store/tables/rows.h"

namespace irsig {

// Returns the fraction of each pixel that the target fills [pixel, row by row from the top left].
[[nodiscard]] std::vector<float> filled_fractions(const StoredSilhouette& silhouette);

// Returns the pixels that show any of the target, and their box.
[[nodiscard]] ImageContent covered_pixels(const StoredSilhouette& silhouette);

// Returns [pixel] 1 + the index in `parts` of the part that most samples of the pixel meet; 0 where
// the target fills less than half of the pixel.
[[nodiscard]] std::vector<std::uint16_t> part_mask(const StoredSilhouette& silhouette,
                                                   const std::vector<std::string>& parts);

// Visible pixels of some parts: pixels that the parts together fill by at least half. If there are
// none, as for a target smaller than a pixel: pixels that show any of the parts.
struct SeenObject {
  double area_px = 0;  // of its fractions of all pixels
  std::uint32_t left_px = 0, top_px = 0, width_px = 0, height_px = 0;  // box around its pixels
  // Corners of the smallest rectangle around its pixels, whatever its direction: x and y of each,
  // from the image's top left corner.
  std::array<double, 8> rectangle_px{};
  // Lengths of runs of pixels outside and inside by turns, column by column from the top left.
  std::vector<std::uint32_t> runs;
};
// An object including the area that other parts hide.
struct WholeObject {
  SeenObject mask;
  double occlusion = 0;   // fraction of its area in the image that other parts hide
  double truncation = 0;  // fraction of its area that lies outside the frame
};
// Returns the whole of a visible object. nullopt: the silhouette has no whole parts.
[[nodiscard]] std::optional<WholeObject> whole_object(
    const StoredSilhouette& silhouette, const SeenObject& seen,
    const std::function<bool(const std::string&)>& has);

// Returns the visible pixels of an object. has: callback that returns true if a part belongs to the
// object. nullopt: no sample meets such a part.
[[nodiscard]] std::optional<SeenObject> seen_object(
    const StoredSilhouette& silhouette, const std::function<bool(const std::string&)>& has);

}  // namespace irsig
