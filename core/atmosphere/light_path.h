#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/atmosphere/air_profile.h"
#include "core/base/constants.h"

namespace irsig {

enum class PathEnd { kRange, kSurface, kSpace };

// A light ray through the air, from the observer outwards. Nodes are the ends of its steps; only
// the part inside the air is listed.
struct LightPath {
  struct Node {
    double height_m;
    double zenith_deg;  // of the ray's direction away from the observer, from the local vertical
    double central_angle_deg;  // at the Earth's centre, from the observer
  };
  std::vector<Node> node;      // one more than step_m; empty if the ray misses the air
  std::vector<double> step_m;  // arc lengths
  double length_m = 0;         // from the observer to the end, air or not; infinite if in space
  PathEnd end = PathEnd::kRange;
  double bending_deg = 0;  // by refraction, in all
};

// Returns the least height of a path's nodes; infinite for one without nodes.
[[nodiscard]] double lowest_height_m(const LightPath& path);

// Rays in air whose refractive index follows the profile (LOWTRAN7's dispersion formula at 2000
// cm-1), above a spherical Earth:
//   d(zenith)/ds = -sin(zenith) (1/r + d ln n / dr)
// integrated in steps of at most 0.5 km of height (lower 6 km) to 15 km, which also end at the
// profile's levels; horizontal, rising, falling and tangent rays by the same equation.
// Limits: near the horizon the truth depends on the lowest 50 m of air, which no standard profile
// describes: the apparent elevation of the sea's horizon, and of what stands behind it, is
// uncertain by 0.05 deg (evaporation ducts, mirages). No ducting is modelled.
//
// From a height (0 or more, also above the air), at a zenith angle (0 up, 180 down), over a range
// (may be infinite) or until the surface or space, whichever comes first.
[[nodiscard]] LightPath look(const AirProfile& air, double height_m, double zenith_deg,
                             double range_m, bool refraction = true);

// Makes a path of a single step that follows the Earth's curvature at one height ("horizontal" in
// other codes); the air is the same all along it.
[[nodiscard]] LightPath level_path(double height_m, double range_m);

// Makes a path between two points given by their heights and their distance along the straight
// line. It starts at the observer and bends as the air has it; range_m 0 gives a path without
// steps. INVALID_ARGUMENT: the range is less than the difference of heights, or more than the
// distance of points on opposite sides of the Earth. OUT_OF_RANGE: the Earth hides one point from
// the other.
[[nodiscard]] absl::StatusOr<LightPath> look_between(const AirProfile& air,
                                                     double observer_height_m,
                                                     double target_height_m, double range_m,
                                                     bool refraction = true);

// The ray that touches the surface, either way from where it touches: what lies below it is hidden
// from whoever is on it, and where it meets an observer is his horizon.
//
// With refraction by look()'s equations in steps of 2 km, without it in closed form. Heights are
// those of the profile, at least its lowest. Accuracy: heights within 0.01 m of a quadrature of
// Bouguer's law up to 20 km (tests/physics/horizon_test.cpp). Limits: look()'s; where air bends
// rays more than the Earth is curved, none has such a ray, and it is the straight one.
class GrazingRay {
 public:
  GrazingRay() = default;  // without air, above a sphere of the Earth's radius
  explicit GrazingRay(const AirProfile& air, bool refraction = true);

  // Returns the central angle from the tangent point to a height. [rad]
  [[nodiscard]] double angle_rad(double height_m) const;
  [[nodiscard]] double height_m(double angle_rad) const;
  // Returns the elevation of the ray above the local horizontal at a height: the dip of the horizon
  // seen from there. [rad]
  [[nodiscard]] double dip_rad(double height_m) const;
  // Returns the bending of the ray between its tangent point and a height. [rad]
  [[nodiscard]] double bending_rad(double height_m) const;
  [[nodiscard]] double bottom_m() const { return bottom_m_; }
  [[nodiscard]] bool straight() const { return point_.empty(); }

 private:
  struct Point {
    double height_m, angle, elevation;
  };
  struct Piece;
  double bottom_m_ = 0;
  std::vector<Point> point_;  // empty: straight
};

}  // namespace irsig
