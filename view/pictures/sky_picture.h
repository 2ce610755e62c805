#pragma once

#include <cstdint>
#include <optional>

#include "absl/status/statusor.h"
#include "schema/job.pb.h"
#include "schema/store/reader.h"
#include "view/draw/false_color.h"
#include "view/query/query.h"

namespace irsig {

// Draws the in-band radiance of the sky around a target in all directions above the horizontal. The
// projection is equal-area, seen from above: the bow is up, the zenith in the centre, as in
// plot_map. The radiance is the light that a run lets the target reflect: cloud and scattered
// sunlight are included, the sun's disk is not. The sun and the north are labelled.
//   condition  index into the sweep's conditions
//   side_px    side of the picture, > 0
// FAILED_PRECONDITION: the condition has no embedded atmosphere.
[[nodiscard]] absl::StatusOr<FalseColorPicture> draw_sky(const schema::ResolvedSweep& sweep,
                                                         int condition, const schema::Band& band,
                                                         std::uint32_t side_px);

// Draws the sky of a stored sweep. `query` selects sweep, season, time and band as far as there are
// several, or the row of a signature for all of these; INVALID_ARGUMENT if it selects several
// conditions or bands, or has another filter.
//   range  [W/(m2 sr)]; without: from the smallest to the largest
[[nodiscard]] absl::StatusOr<FalseColorPicture> sky_picture(StoreReader& reader, const Query& query,
                                                            const std::optional<ColorRange>& range,
                                                            std::uint32_t side_px);

}  // namespace irsig
