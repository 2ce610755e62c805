#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geo/line_of_sight.h"
#include "core/land/land_scene.h"

namespace irsig {

// Draws land from above as SVG, north up: each pixel has the colour of the material with the
// largest fraction, shaded by the slope of the land under light from the northwest. A circle with a
// line along the bow marks the target.
//   material  names, [of the cover]
//   long_side_px  of the map; > 0
[[nodiscard]] std::string draw_land(const LandScene& land, const GeodeticPosition& origin,
                                    const std::vector<std::string>& material,
                                    const std::string& title, std::uint32_t long_side_px);

// Draws the land of a sweep in a database, or of a sweep file. INVALID_ARGUMENT: a sweep without
// [land].
[[nodiscard]] absl::StatusOr<std::string> land_picture(const std::string& database,
                                                       const std::string& sweep,
                                                       std::uint32_t long_side_px);

}  // namespace irsig
