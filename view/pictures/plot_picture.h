#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "view/draw/false_color.h"
#include "view/pictures/thumbnail.h"
#include "view/query/query.h"

namespace irsig {

// The stored image of the only row that a query selects (an aspect alone: the nearest viewpoint) in
// false colours: in-band radiance at the target, without the air, from the smallest to the largest
// of the target's pixels or over `range` [W/(m2 sr)]; beside it the temperature of the blackbody
// with the same in-band radiance. Errors: those of run_query and of stored_thumbnail (thumbnail.h);
// NOT_FOUND: it shows nothing of the target.
//
// A stored image has its paths in however many pixels were asked for: with one path each, a pixel
// that has it is far too bright, and its neighbours are black. So pixels are means over squares of
// stored ones.
//   long_side_px  at most; without: as many as leave 25 paths to a pixel of the target, on the
//                 average. INVALID_ARGUMENT: more than are stored
[[nodiscard]] absl::StatusOr<FalseColorPicture> radiance_picture(
    StoreReader& reader, const Query& query, const std::optional<ColorRange>& range,
    const std::optional<std::uint32_t>& long_side_px, const ReadPictures& read);

}  // namespace irsig
