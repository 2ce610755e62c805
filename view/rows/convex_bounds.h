#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/geo/frames.h"

namespace irsig {

// Bounds, between viewpoints, on the intensity of a convex body whose facets emit and reflect
// diffusely. Number, place and radiance of the facets need not be known.
//
//   I(d) = sum over facets of a_f max(0, n_f . d),  a_f >= 0            [W/sr]
//
// is a convex function of the vector d, homogeneous of degree 1. Where d = sum of c_i d_i,
//
//   I(d) <= sum of c_i I(d_i)   if no c_i is negative,
//   I(d) >= sum of c_i I(d_i)   if exactly one c_i is positive,
//
// and combinations of three viewpoints are enough for the best bounds (a linear program with three
// constraints). The bounds hold wherever the edges of facets lie between the viewpoints.
//
// Accuracy: proven for such a body and exact values; two standard errors of a combination widen its
// bound. Combinations are made of 16 viewpoints (the two nearest of each of eight bearings); more
// viewpoints could only narrow the bounds.
// Limits: at the edge of a set, or for a single ring above the horizon, no combination may bound
// one side. Then two viewpoints are used whose plane passes at a distance r of d, and r times the
// largest value widens the bound. This is proven only if the body is no brighter along the plane's
// normal.
class ConvexBounds {
 public:
  // among: indices into direction, the nearest to `where` first.
  ConvexBounds(const std::vector<Vec<Body>>& direction, const std::vector<std::size_t>& among,
               Vec<Body> where);

  struct Interval {
    std::optional<double> low, high;  // nullopt: no combination bounds this side
  };
  // Returns the bounds of the value at `where`. value, value_stderr: in the order of direction.
  [[nodiscard]] Interval of(const std::vector<double>& value,
                            const std::vector<double>& value_stderr) const;

 private:
  struct Combination {
    std::array<std::size_t, 3> sample;
    std::array<double, 3> coefficient;
    double distance;  // of `where` from the plane of two viewpoints; 0: none
    bool is_upper;
  };
  void add(std::array<std::size_t, 3> sample, std::array<double, 3> coefficient, double distance);

  std::vector<Combination> combination_;  // those without a distance first
};

// Returns the rms distance from `value` to a uniform distribution over the interval. A missing side
// counts as equally distant as the other side. If the interval is empty by a little (low above
// high, from noise), the distance to the farther end is returned. nullopt: both sides are missing,
// or they contradict each other by more than half of that distance, as for a body that is not
// convex.
[[nodiscard]] std::optional<double> rms_distance(double value, const ConvexBounds::Interval& in);

}  // namespace irsig
