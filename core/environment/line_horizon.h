#pragma once

#include "core/atmosphere/light_path.h"
#include "core/environment/view_environment.h"

namespace irsig {

// The background in one direction behind the target.
struct BehindSight {
  bool sky;
  // Sine of the ray's elevation where it passes the target, for the sky. Below the horizon: sine of
  // the depression at which the surface is seen under the same angle from the target's point.
  double sine;
  // A ray that falls and yet misses the Earth: how far it is towards the one that touches, 0 .. 1.
  // 0 for all others.
  double limb;
  Vec<Body> direction;  // of the ray there; of the sea, where it meets the surface. Unit vector
};

// The horizon of one line of sight in the air of one weather: rays that leave the sensor, pass the
// target's vertical at some height and end in the sky or on the surface beyond. One geometry for
// what the Earth hides, where the sea ends and what air the ray meets: all rays are those of
// look() from the sensor, told apart by where they pass the target's vertical.
//
// A ray is above the horizon if it passes there above the one that touches the surface; if the
// target stands beyond the place where that one touches, all others are hidden.
//
// Accuracy: z within 1e-7 + 0.01 m / range of the ray that touches; the lift of other rays is that
// of the line's own, to 1 % of it for targets of 50 m (tests/physics/horizon_test.cpp).
class LineHorizon {
 public:
  // ray outlives it.
  //   height_m  of the target's point, as the profile counts
  //   lift_rad  by how much a ray from the sensor points lower at the target than the straight line
  LineHorizon(const GrazingRay& ray, double height_m, const SensorLine& line, double lift_rad);

  // Returns the end of the sea: z of the straight line from the sensor to the height at which the
  // ray that touches the surface passes the target (BackgroundDirections).
  [[nodiscard]] float z() const { return z_; }
  [[nodiscard]] SeaHorizon horizon() const;
  [[nodiscard]] BehindSight sight(const BackgroundDirections& nodes, double z, bool above) const;

 private:
  const GrazingRay& ray_;
  double height_m_, lift_rad_, elevation_rad_, sensor_up_m_, sensor_along_m_;
  // The sensor; central angles from it to the target, and to where the ray touches; how high that
  // ray passes the target.
  double sensor_m_, between_rad_, to_touch_rad_, passes_m_;
  float z_;
};

}  // namespace irsig
