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
  // Takes at least one z, increasing; two equal z mark a jump of radiance. Directions beyond the
  // first or last node take the radiance of that node.
  explicit BackgroundDirections(std::vector<float> z, double azimuth_rad = 0);
  // Returns as many directions as are needed from one z to another, with a jump at each of `breaks`
  // in between. They are densest close to a horizon and below it, where the path through the air
  // changes fastest.
  [[nodiscard]] static BackgroundDirections spanning(double from_z, double to_z,
                                                     std::vector<float> breaks, double azimuth_rad);

  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(z_.size()); }
  [[nodiscard]] float z(std::uint32_t node) const { return z_[node]; }
  // Returns true if a node is above a horizon at that z; of two nodes that coincide there, the
  // first is.
  [[nodiscard]] bool above(std::uint32_t node, float horizon_z) const;
  // Returns the unit vector away from the sensor.
  [[nodiscard]] Vec<Body> direction(double z) const;

  struct Share {
    std::uint32_t node;
    float weight;
  };
  // Computes the interpolation weights of a direction: one or two that add up to 1. Returns their
  // number.
  int shares(float z, Share* out) const;

 private:
  std::vector<float> z_;
  double azimuth_rad_;
};

}  // namespace irsig
