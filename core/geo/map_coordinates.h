#pragma once

#include "core/geo/frames.h"
#include "core/geo/line_of_sight.h"

namespace irsig {

// Returns the geodetic position of a point of the local frame at `origin`. Accuracy: 1e-8 m within
// 1e6 m of it.                                                                          [wgs84]
[[nodiscard]] GeodeticPosition geodetic_position(const GeodeticPosition& origin, Vec<Enu> point_m);

// A zone of the universal transverse Mercator grid on WGS 84: EPSG 32600 + zone, or 32700 + zone.
struct UtmZone {
  int zone = 1;  // [1, 60]
  bool south = false;
};

struct UtmPoint {
  double easting_m,
      northing_m;  // 500 km at the central meridian; 0 (south: 10 000 km) at the equator
};

// Returns the grid coordinates of a position, also beyond the zone's 6 degrees. Accuracy: 5e-9 m
// within 35 degrees of the central meridian.
[[nodiscard]] UtmPoint utm_point(const UtmZone& zone, double latitude_deg, double longitude_deg);

}  // namespace irsig
