#include "core/geo/frames.h"

#include <GeographicLib/Math.hpp>

namespace irsig {
namespace {

// Exact at the multiples of 90 degrees, so that a ship heading north sees its sides exactly east
// and west.
struct SinCos {
  double sin, cos;
};
SinCos sin_cos(double angle_deg) {
  SinCos out{};
  GeographicLib::Math::sincosd(angle_deg, out.sin, out.cos);
  return out;
}

}  // namespace

Vec<Body> body_from_enu(Vec<Enu> v, double heading_deg) {
  const SinCos heading = sin_cos(heading_deg);
  return {v.x * heading.sin + v.y * heading.cos, v.x * heading.cos - v.y * heading.sin, -v.z};
}

Vec<Enu> enu_from_body(Vec<Body> v, double heading_deg) {
  const SinCos heading = sin_cos(heading_deg);
  return {v.x * heading.sin + v.y * heading.cos, v.x * heading.cos - v.y * heading.sin, -v.z};
}

Vec<Body> body_from_aspect(double aspect_azimuth_deg, double aspect_elevation_deg) {
  const SinCos azimuth = sin_cos(aspect_azimuth_deg);
  const SinCos elevation = sin_cos(aspect_elevation_deg);
  return {elevation.cos * azimuth.cos, elevation.cos * azimuth.sin, -elevation.sin};
}

}  // namespace irsig
