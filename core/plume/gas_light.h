#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/plume/gas_segments.h"

namespace irsig {

// Source function of one segment: its mean over the segment's amount, its change from the near to
// the far end, and its standard deviation from the mean.
struct SegmentSource {
  double mean = 0, change = 0, spread = 0;  // of a radiance, or of whatever is to be had
};

// Computes the source of a segment from a blackbody function of temperature, taken at one standard
// deviation below and above the mean. It is exact for a source that is quadratic in the
// temperature, and so, with the mean, change and spread of segments, of third order in their step.
[[nodiscard]] SegmentSource segment_source(const GasSegment& segment,
                                           const std::function<double(double)>& blackbody);

// Light through a row of segments, from near to far.
struct GasLight {
  double emitted = 0;        // towards the near end
  double transmittance = 1;  // of all
  double contrast = 0;       // emitted + transmittance x background - background
  double absorptance = 0;    // 1 - transmittance, without cancellation
};

// Computes the light of homogeneous segments of optical depth tau, whose source is linear in tau,
//
//   L = mean E + change G,  E = 1 - exp(-tau),  G = E / tau - exp(-tau) - E / 2
//
// one formula from tau = 0 to infinity: E by expm1, G by its series where tau < 0.7. The contrast
// is a sum of (mean - background) E: nothing cancels at 1e-12. `background` is a uniform radiance
// behind. optical_depth, source: as many as segments. Errors: 4 units in the last place of each
// term.
[[nodiscard]] GasLight light_through(std::span<const double> optical_depth,
                                     std::span<const SegmentSource> source, double background = 0);

// Estimates the error of `emitted` from the finite steps of segments, one sigma: each coarse step
// (coarser() in gas_segments.h) shaded as one against its segments, and for each segment a third of
// (spread / mean)^3 of its emission, the first term that mean and spread leave out (where a
// temperature rises and falls symmetrically, merging changes nothing). All count as
// independent errors.
[[nodiscard]] double step_error(std::span<const double> optical_depth,
                                std::span<const SegmentSource> source,
                                std::span<const CoarseStep> coarse,
                                std::span<const double> coarse_optical_depth,
                                std::span<const SegmentSource> coarse_source);

// Returns G(tau) above.
[[nodiscard]] double linear_source_fraction(double optical_depth);

}  // namespace irsig
