#include "core/geo/line_of_sight.h"

#include <GeographicLib/LocalCartesian.hpp>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/check.h"
#include "core/base/constants.h"

namespace irsig {
namespace {

GeographicLib::LocalCartesian frame_at(const GeodeticPosition& origin) {
  IRSIG_CHECK(std::abs(origin.latitude_deg) <= 90.0);
  return {origin.latitude_deg, origin.longitude_deg, origin.height_m};
}

GeodeticPosition position(const GeographicLib::LocalCartesian& frame, Vec<Enu> point) {
  GeodeticPosition out{};
  frame.Reverse(point.x, point.y, point.z, out.latitude_deg, out.longitude_deg, out.height_m);
  return out;
}

double lowest_height_m(const GeographicLib::LocalCartesian& frame, Vec<Enu> from_m, Vec<Enu> to_m) {
  const auto height_at = [&](double t) {
    return position(frame, (1.0 - t) * from_m + t * to_m).height_m;
  };
  // The signed distance from a convex body is a convex function along a line: golden section finds
  // its minimum.
  constexpr double kGolden = std::numbers::phi - 1.0;
  double low = 0.0;
  double high = 1.0;
  double left = 1.0 - kGolden;
  double right = kGolden;
  double height_left = height_at(left);
  double height_right = height_at(right);
  // 0.618^48 = 1e-10: along 1000 km the place is known to 0.1 mm; the height there varies with its
  // square.
  for (int i = 0; i < 48; ++i) {
    if (height_left < height_right) {
      high = right;
      right = left;
      height_right = height_left;
      left = high - kGolden * (high - low);
      height_left = height_at(left);
    } else {
      low = left;
      left = right;
      height_left = height_right;
      right = low + kGolden * (high - low);
      height_right = height_at(right);
    }
  }
  return std::min({height_left, height_right, height_at(0.0), height_at(1.0)});
}

}  // namespace

LineOfSight line_of_sight(const GeodeticPosition& target, double heading_deg,
                          const Viewpoint& viewpoint) {
  const GeographicLib::LocalCartesian frame = frame_at(target);
  const Vec<Enu> to_sensor =
      viewpoint.range_m *
      enu_from_body(body_from_aspect(viewpoint.aspect_azimuth_deg, viewpoint.aspect_elevation_deg),
                    heading_deg);
  LineOfSight out{};
  std::vector<double> target_from_sensor(9);  // rotation of local vectors, row-major
  frame.Reverse(to_sensor.x, to_sensor.y, to_sensor.z, out.sensor.latitude_deg,
                out.sensor.longitude_deg, out.sensor.height_m, target_from_sensor);
  const auto towards_target = [&](std::size_t axis) {  // column `axis` of the rotation, transposed
    return -(target_from_sensor[axis] * to_sensor.x + target_from_sensor[3 + axis] * to_sensor.y +
             target_from_sensor[6 + axis] * to_sensor.z);
  };
  const double horizontal = std::hypot(towards_target(0), towards_target(1));
  out.los_zenith_deg = std::atan2(horizontal, towards_target(2)) / kRadPerDeg;
  out.lowest_height_m = lowest_height_m(frame, {}, to_sensor);
  return out;
}

double height_m(const GeodeticPosition& origin, Vec<Enu> point_m) {
  return position(frame_at(origin), point_m).height_m;
}

double lowest_height_m(const GeodeticPosition& origin, Vec<Enu> from_m, Vec<Enu> to_m) {
  return lowest_height_m(frame_at(origin), from_m, to_m);
}

}  // namespace irsig
