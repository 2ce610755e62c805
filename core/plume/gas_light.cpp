#include "core/plume/gas_light.h"

#include <cmath>

#include "core/base/check.h"

namespace irsig {

double linear_source_fraction(double tau) {
  if (tau > 0.7) return -std::expm1(-tau) / tau - std::exp(-tau) + 0.5 * std::expm1(-tau);
  // 1/2 sum over k >= 1 of (-1)^k k tau^(k+1) / (k+2)!
  double sum = 0, term = tau / 2;  // tau^(k+1) / (k+2)! with k = 0
  for (int k = 1; k <= 16; ++k) {
    term *= -tau / (k + 2);
    sum += k * term;
  }
  return 0.5 * sum;
}

SegmentSource segment_source(const GasSegment& segment,
                             const std::function<double(double)>& blackbody) {
  const double spread = segment.temperature_spread_k;
  if (!(spread > 0)) return {blackbody(segment.temperature_k), 0};
  const double low = blackbody(segment.temperature_k - spread);
  const double high = blackbody(segment.temperature_k + spread);
  return {0.5 * (low + high), (high - low) / (2 * spread) * segment.temperature_change_k,
          0.5 * std::abs(high - low)};
}

GasLight light_through(std::span<const double> optical_depth, std::span<const SegmentSource> source,
                       double background) {
  IRSIG_CHECK(optical_depth.size() == source.size());
  GasLight out;
  double in_front = 0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const double tau = optical_depth[i], passed = std::exp(-in_front);
    const double absorbed = -std::expm1(-tau);
    const double line = source[i].change == 0 ? 0 : source[i].change * linear_source_fraction(tau);
    out.emitted += passed * (source[i].mean * absorbed + line);
    out.contrast += passed * ((source[i].mean - background) * absorbed + line);
    in_front += tau;
  }
  out.transmittance = std::exp(-in_front);
  out.absorptance = -std::expm1(-in_front);
  return out;
}

double step_error(std::span<const double> optical_depth, std::span<const SegmentSource> source,
                  std::span<const CoarseStep> coarse, std::span<const double> coarse_optical_depth,
                  std::span<const SegmentSource> coarse_source) {
  double in_front = 0, squares = 0;
  std::size_t first = 0;
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    const std::size_t count = coarse[i].count;
    const GasLight fine =
        light_through(optical_depth.subspan(first, count), source.subspan(first, count));
    const GasLight one =
        light_through(coarse_optical_depth.subspan(i, 1), coarse_source.subspan(i, 1));
    const double error = std::exp(-in_front) * (fine.emitted - one.emitted);
    squares += error * error;
    for (std::size_t j = first; j < first + count; ++j) {
      const SegmentSource& own = source[j];
      if (own.spread > 0) {
        const double share = own.spread / own.mean;
        const double left_out = std::exp(-in_front) * -std::expm1(-optical_depth[j]) * own.mean *
                                share * share * share / 3;
        squares += left_out * left_out;
      }
      in_front += optical_depth[j];
    }
    first += count;
  }
  IRSIG_CHECK(first == source.size());
  return std::sqrt(squares);
}

}  // namespace irsig
