#pragma once

#include <vector>

#include "view/moved/silhouette.h"

namespace irsig {

// Effect of perspective on a target that is seen from another range on the same aspect.
struct ShapeChange {
  double area_ratio = 1;    // of the silhouette
  double target_ratio = 1;  // of the light that leaves the target for the sensor
  // Relative bounds on both.
  double area_bound = 0, target_bound = 0;
};

// Light of each part of one stored row. In-band numbers.
struct PartLight {
  double intensity_w_sr;
  // The radiance of a blackbody at the part's stated temperature [W/(m2 sr)]; NaN: none is stated.
  double blackbody_w_m2_sr;
  // Fraction of its light that may be spread unevenly over it: 0 for black surfaces of one
  // temperature.
  double uneven;
};

// One viewpoint at two ranges: all values that do not depend on the row.
class ShapeAtRanges {
 public:
  ShapeAtRanges(const TargetShape& shape, const Viewpoint& from, double to_range_m, bool waterline,
                const Silhouette& before, const Silhouette& after);

  // Returns the change of a row between both ranges. Each part keeps its own radiance, so that its
  // light is proportional to its visible area:
  //
  //   ratio = g + sum over parts p of (L_p - L) (A_p(R) - g A_p(R0)) / I(R0),  g = A(R) / A(R0)
  //
  // with L the mean radiance. Three causes have bounds: the unevenly distributed light of a part
  // times the relative change of its facets; parts that the stored viewpoint does not see; and the
  // cells of the raster that gives A_p.
  [[nodiscard]] ShapeChange of(const std::vector<PartLight>& part) const;

 private:
  double before_m2_, after_m2_, ratio_, area_bound_;
  std::vector<double> change_;          // [part] facet_changes
  PartAreas before_part_, after_part_;  // empty: one part
};

}  // namespace irsig
