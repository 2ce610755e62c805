#include "view/moved/shape_change.h"

#include <algorithm>
#include <cmath>

namespace irsig {

ShapeAtRanges::ShapeAtRanges(const TargetShape& shape, const Viewpoint& from, double to_range_m,
                             bool waterline, const Silhouette& before, const Silhouette& after)
    : before_m2_(before.area_m2()),
      after_m2_(after.area_m2()),
      ratio_(after_m2_ / before_m2_),
      area_bound_(before.area_error_m2() / before_m2_ + after.area_error_m2() / after_m2_),
      change_(facet_changes(shape, from, to_range_m, waterline)) {
  if (shape.two_sided.size() < 2) return;
  before_part_ = part_areas(shape, from, waterline);
  Viewpoint to = from;
  to.range_m = to_range_m;
  after_part_ = part_areas(shape, to, waterline);
}

ShapeChange ShapeAtRanges::of(const std::vector<PartLight>& part) const {
  ShapeChange out{ratio_, ratio_, area_bound_, 0};
  double whole = 0;
  for (const PartLight& p : part) whole += p.intensity_w_sr;
  if (!(whole > 0)) {
    out.target_bound = area_bound_ + *std::max_element(change_.begin(), change_.end());
    return out;
  }
  if (before_part_.area_m2.empty()) {
    out.target_bound = area_bound_ + part.front().uneven * change_.front();
    return out;
  }
  const double mean = whole / before_m2_;
  double uneven = 0, brightest = mean;
  for (std::size_t p = 0; p < part.size(); ++p) {
    uneven = std::max(uneven, part[p].uneven);
    if (before_part_.area_m2[p] > 3 * before_part_.error_m2[p])
      brightest = std::max(brightest, part[p].intensity_w_sr / before_part_.area_m2[p]);
  }
  double moved = 0, bound = 0;
  for (std::size_t p = 0; p < part.size(); ++p) {
    const double before = before_part_.area_m2[p], after = after_part_.area_m2[p];
    const double error = std::hypot(ratio_ * before_part_.error_m2[p], after_part_.error_m2[p]);
    const double light = part[p].intensity_w_sr;
    if (before <= 3 * before_part_.error_m2[p]) {
      // Hardly seen before: what is not known of it is all that it may add.
      const double blackbody = part[p].blackbody_w_m2_sr;
      const double off =
          std::isnan(blackbody) ? brightest : std::max(std::abs(blackbody - mean), uneven * mean);
      bound += (after + 3 * error) * off;
      continue;
    }
    const double radiance = light / before;
    moved += (radiance - mean) * (after - ratio_ * before);
    bound += std::abs(radiance - mean) * error + light * part[p].uneven * change_[p];
  }
  out.target_ratio = std::max(0.0, ratio_ + moved / whole);
  out.target_bound = area_bound_ + bound / (whole * ratio_);
  return out;
}

}  // namespace irsig
