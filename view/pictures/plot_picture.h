#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "view/draw/false_color.h"
#include "view/pictures/sweep_imager.h"
#include "view/pictures/thumbnail.h"
#include "view/query/query.h"

namespace irsig {

// The stored image of the only row that a query selects (an aspect alone: the nearest viewpoint) in
// false colours: in-band radiance at the target, without the air, from the first to the
// 99th percentile of the target's pixels or over `range` [W/(m2 sr)]; beside it the temperature of
// the blackbody with the same in-band radiance. Errors: those of run_query and of stored_thumbnail
// (thumbnail.h); NOT_FOUND: it shows nothing of the target.
//
//   layer         empty: the radiance at the target; else a further image of the row
//   (kImageLayers).
//                 NOT_FOUND: the row has no such layer
//   imager        if there is one, the picture shows its counts, whole pixels of the camera;
//                 errors: those of counts_of_row (sweep_imager.h)
//   long_side_px  at most: pixels are means over squares of stored ones; without: as many as are
//                 stored. INVALID_ARGUMENT: more than are stored
[[nodiscard]] absl::StatusOr<FalseColorPicture> radiance_picture(
    StoreReader& reader, const Query& query, const std::optional<ColorRange>& range,
    const std::optional<std::uint32_t>& long_side_px, const ReadPictures& read,
    const std::string& layer = "", const std::optional<SweepImager>& imager = std::nullopt);

// Returns the stored images of up to 200 rows of one sweep and band, on one scale, each with a
// label of what is its own: season, time, azimuth and elevation. Arguments and errors as above.
[[nodiscard]] absl::StatusOr<FalseColorPicture> sheet_picture(
    StoreReader& reader, const Query& query, const std::optional<ColorRange>& range,
    const std::optional<std::uint32_t>& long_side_px, const ReadPictures& read,
    const std::string& layer = "", const std::optional<SweepImager>& imager = std::nullopt);

}  // namespace irsig
