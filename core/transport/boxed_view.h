#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "absl/status/statusor.h"
#include "core/transport/primary_rays.h"

namespace irsig {

// BoxedSight describes what a view shows beside its target: boxes in which all of it lies (corners
// in the body frame), and small spheres of what is in them.
struct BoxedSight {
  std::vector<std::array<Vec<Body>, 8>> box;
  struct Point {
    Vec<Body> at;
    double reach_m;               // across
    std::array<double, 2> sends;  // if nothing were before it: two measures, which count alike
    double amount;                // of what absorbs, in any one unit
  };
  std::vector<Point> point;
};

// Distribution of the light's origin over the cells of the image plane, for points that absorb
// nothing, or so much that the densest column of them has one of a few optical depths: points
// absorb the light behind them. Real gas is thin at some wavelengths and thick at others, so that
// all of these cases count.
class SightShares {
 public:
  static constexpr std::array<double, 5> kOpticalDepth = {0, 1, 10, 100, 1000};
  //   seen      [optical depth][measure][cell]
  //   of_rays   [cell] the density of rays
  SightShares(std::array<std::array<std::vector<double>, 2>, kOpticalDepth.size()> seen,
              std::vector<double> of_rays);

  // Returns the share of what is seen at optical depth `depth` by `measure` that so many rays may
  // all have missed, with a chance of 5 %: the brightest cells that together expect three rays,
  // less what the darker ones would make of them. It is 0 where rays are as dense as what is seen.
  [[nodiscard]] double missed(std::size_t depth, std::size_t measure, double rays) const;

 private:
  std::array<std::array<std::vector<double>, 2>, kOpticalDepth.size()> seen_;
  std::vector<double> of_rays_;
};

struct BoxedView {
  AimedView view;
  SightShares sight;
};
// Makes a view of boxes before and beside a target: one stratum, for all parts, over the cells of
// the image plane that the boxes touch, a fifth of its rays spread evenly, the rest by the seen
// boxes. The image plane, where rays begin, lies before both. INVALID_ARGUMENT: the sensor is
// within a
// hundredth of its range of what is to be seen, along the line of sight.
[[nodiscard]] absl::StatusOr<BoxedView> make_boxed_view(const Target& target,
                                                        const Viewpoint& viewpoint,
                                                        const BoxedSight& sight);

}  // namespace irsig
