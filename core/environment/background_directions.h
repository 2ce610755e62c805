#pragma once

#include <cstdint>
#include <vector>

#include "core/geo/frames.h"

namespace irsig {

// Directions of lines of sight beyond the target at which the radiance that stands there is known;
// between two of them it is linear in the direction's z. Where the sea ends for the sensor the
// radiance jumps: there two nodes coincide, the first of which is above the horizon.
//
// A direction is that of the straight line from the sensor, by the z of its unit vector (body
// frame, > 0: it falls away from the sensor), whatever the air makes of it; all have one azimuth.
class BackgroundDirections {
 public:
  // One node above the horizontal, one below.
  BackgroundDirections() : BackgroundDirections({0, 0}) {}
  // z: increasing, at least one; equal where radiance jumps. Directions beyond the first and the
  // last take its radiance.
  explicit BackgroundDirections(std::vector<float> z, double azimuth_rad = 0);
  // As many as are needed from one z to another with a jump at each of `breaks` in between: close
  // to a horizon, where the way through the air changes fastest, and below it above all.
  [[nodiscard]] static BackgroundDirections spanning(double from_z, double to_z,
                                                     std::vector<float> breaks, double azimuth_rad);

  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(z_.size()); }
  [[nodiscard]] float z(std::uint32_t node) const { return z_[node]; }
  // Whether a node is above a horizon that lies at that z: of two that coincide there the first.
  [[nodiscard]] bool above(std::uint32_t node, float horizon_z) const;
  // Unit vector away from the sensor.
  [[nodiscard]] Vec<Body> direction(double z) const;

  struct Share {
    std::uint32_t node;
    float weight;
  };
  // Of a direction: one or two shares that add up to 1. Returns how many.
  int shares(float z, Share* out) const;

 private:
  std::vector<float> z_;
  double azimuth_rad_;
};

}  // namespace irsig
