#pragma once

#include <cstdint>
#include <optional>

#include "absl/status/statusor.h"
#include "core/geo/line_of_sight.h"
#include "core/land/height_field.h"
#include "core/land/height_raster.h"

namespace irsig {

// The vertices of a map in the local frame of its origin.
struct LandMap {
  GeodeticPosition origin;
  double west_m = 0, south_m = 0, spacing_m = 0;
  std::uint32_t columns = 0, rows = 0;  // cells
  double geoid_m = 0;                   // height of the geoid above the ellipsoid
  std::optional<double> fill_m;         // height above the geoid where the raster has none
};

// Places the heights of a raster on the ellipsoid: each vertex has the height that the raster has
// at the vertex's own latitude and longitude, interpolated between four samples. [wgs84]
//
// Accuracy: z within 1 cm of the exact place where the map spans at most 5000 m of heights and 100
// km (tests/unit/place_heights_test.cpp). Limits: vertices at most 400 km east or north of the
// origin and below a latitude of 89 degrees; a raster of degrees is not continued at its own end.
// INVALID_ARGUMENT: these limits, and vertices without a height where fill_m is not given.
[[nodiscard]] absl::StatusOr<HeightGrid> place_heights(const HeightRaster& raster,
                                                       const LandMap& map);

}  // namespace irsig
