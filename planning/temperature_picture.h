#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "planning/sweep_facets.h"
#include "view/draw/false_color.h"
#include "view/query/query.h"

namespace irsig {

// Draws the temperatures of a target's facets as seen from an aspect. One parallel ray passes
// through the middle of each pixel; the pixel shows the temperature of the first facet met, from
// either side.
//   condition     index into the sweep's conditions
//   long_side_px  of the picture, which the target's outline fills; > 0
[[nodiscard]] absl::StatusOr<FalseColorPicture> draw_temperatures(
    const SweepFacets& facets, int condition, const SignatureFilter::Direction& aspect,
    std::uint32_t long_side_px);

// Makes the picture of a stored sweep. `query` selects sweep, season and time, if there are
// several, and an aspect, which need not be that of a viewpoint; or the row of a signature, for all
// of these. range [K]: unset: from the coldest to the hottest pixel. INVALID_ARGUMENT: the query
// selects several conditions (the message lists them) or none, or uses other filters of signatures.
[[nodiscard]] absl::StatusOr<FalseColorPicture> temperature_picture(
    const std::string& database, const Query& query, const std::optional<ColorRange>& range,
    std::uint32_t long_side_px);

}  // namespace irsig
