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

// Returns the stored image of the only row that a query selects, in false colours; a query with an
// aspect alone selects the nearest viewpoint. The values are in-band radiance at the target,
// without the air. They extend over `range` [W/(m2 sr)], or from the first to the 99th percentile
// of the target's pixels. A second scale shows the temperature of the blackbody with the same
// in-band radiance. Errors are those of run_query and of stored_thumbnail (thumbnail.h); NOT_FOUND:
// the image shows nothing of the target.
//   layer         empty: radiance at the target; else an image layer of the row (kImageLayers).
//                 NOT_FOUND: the row has no such layer
//   imager        if set, the picture shows the camera's counts in whole pixels; errors: those of
//                 counts_of_row (sweep_imager.h)
//   long_side_px  upper limit: pixels are means over squares of stored pixels; unset: the stored
//                 size. INVALID_ARGUMENT: more pixels than are stored
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
