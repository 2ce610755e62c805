#pragma once

#include "core/geo/frames.h"
#include "core/geo/viewpoint.h"

namespace irsig {

// A point near the WGS 84 ellipsoid, which stands for the sea's surface.             [wgs84]
struct GeodeticPosition {
  double latitude_deg;   // [-90, 90]
  double longitude_deg;  // [-180, 180]
  double height_m;       // above the ellipsoid
};

// The straight line from a target to a sensor. The Earth is curved below it: a sensor at a negative
// aspect elevation may be well above the sea, and one at a small positive elevation is higher than
// range x sin(elevation).
//
// Accuracy: heights to 1e-8 m and directions to 1e-12 deg for ranges up to 1e6 m
// (tests/physics/viewpoint_test.cpp). Limits: a straight line; refraction is a step of its own.
struct LineOfSight {
  GeodeticPosition sensor;
  double
      los_zenith_deg;  // at the sensor, looking towards the target, from the sensor's own vertical
  double lowest_height_m;  // of the line, its ends included: below 0 it runs through the sea
};

[[nodiscard]] LineOfSight line_of_sight(const GeodeticPosition& target, double heading_deg,
                                        const Viewpoint& viewpoint);

// Returns the height of a point of the target's local frame (x east, y north, z up at `origin`), in
// metres above the ellipsoid.
[[nodiscard]] double height_m(const GeodeticPosition& origin, Vec<Enu> point_m);

// Returns the lowest height of the straight segment between two points of that frame: whether the
// sea hides one from the other. A point at the waterline itself has height 0 to rounding (1e-8 m).
[[nodiscard]] double lowest_height_m(const GeodeticPosition& origin, Vec<Enu> from_m,
                                     Vec<Enu> to_m);

}  // namespace irsig
