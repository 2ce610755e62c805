#pragma once

#include <cstdint>
#include <vector>

#include "core/geo/frames.h"

namespace irsig {

// Directions at which the radiance of sky and sea is known; between them it is linear in the sine
// of the elevation and in azimuth. Paths that leave the target add their weight to the nodes around
// their direction, so that any sky can be put in afterwards.
//
// Nodes 0 .. sky() - 1 are above the horizon, sky() .. count() - 1 below; each side has rings of
// constant elevation with `azimuths` nodes each, from first_azimuth_rad clockwise (body frame, 0:
// the bow).
class DirectionNodes {
 public:
  // One node above the horizon, one below: a uniform sky over a uniform sea.
  DirectionNodes() : DirectionNodes({0.0f}, {0.0f}, 1) {}
  // sky_sin, lower_sin: |sin(elevation)| of the rings, increasing, at least one each. Directions
  // beyond the first and the last ring take that ring's radiance.
  DirectionNodes(std::vector<float> sky_sin, std::vector<float> lower_sin, std::uint32_t azimuths,
                 double first_azimuth_rad = 0);

  [[nodiscard]] std::uint32_t sky() const { return sky_; }
  [[nodiscard]] std::uint32_t lower() const { return lower_; }
  [[nodiscard]] std::uint32_t count() const { return sky_ + lower_; }
  [[nodiscard]] bool uniform() const { return sky_ == 1 && lower_ == 1; }
  // Returns true if the rings below begin at the horizontal, as for a target in the air, which sees
  // sky there.
  [[nodiscard]] bool has_limb() const { return lower_sin_.size() > 1 && lower_sin_.front() == 0; }
  [[nodiscard]] std::uint32_t azimuths() const { return azimuths_; }

  struct Share {
    std::uint32_t node;
    float weight;
  };
  // Computes the interpolation weights of a unit vector in the body frame (z down: z < 0 is above
  // the horizon): up to four that add up to 1. Returns their number.
  int shares(float x, float y, float z, Share* out) const;

  // Returns the unit vector towards a node.
  [[nodiscard]] Vec<Body> direction(std::uint32_t node) const;
  // Returns sin(elevation) of the node's ring: negative below the horizon.
  [[nodiscard]] double sin_elevation(std::uint32_t node) const;

 private:
  std::vector<float> sky_sin_, lower_sin_;
  std::uint32_t azimuths_, sky_ = 0, lower_ = 0;
  double first_azimuth_rad_;
};

}  // namespace irsig
