#include "core/geo/map_coordinates.h"

#include <GeographicLib/LocalCartesian.hpp>
#include <GeographicLib/TransverseMercator.hpp>

namespace irsig {

GeodeticPosition geodetic_position(const GeodeticPosition& origin, Vec<Enu> point_m) {
  const GeographicLib::LocalCartesian frame(origin.latitude_deg, origin.longitude_deg,
                                            origin.height_m);
  GeodeticPosition out{};
  frame.Reverse(point_m.x, point_m.y, point_m.z, out.latitude_deg, out.longitude_deg, out.height_m);
  return out;
}

UtmPoint utm_point(const UtmZone& zone, double latitude_deg, double longitude_deg) {
  UtmPoint out{};
  GeographicLib::TransverseMercator::UTM().Forward(6 * zone.zone - 183, latitude_deg, longitude_deg,
                                                   out.easting_m, out.northing_m);
  out.easting_m += 5e5;
  if (zone.south) out.northing_m += 1e7;
  return out;
}

}  // namespace irsig
