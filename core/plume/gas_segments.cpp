#include "core/plume/gas_segments.h"

#include <algorithm>
#include <cmath>

#include "core/base/constants.h"

namespace irsig {

double GasSegment::mole_fraction(std::size_t species) const {
  return amount[species] * kGasConstantJMolK * temperature_k / (pressure_pa * length_m());
}

double GreyAbsorption::optical_depth(const GasSegment& segment) const {
  double out = 0;
  for (std::size_t s = 0; s < kPlumeSpecies; ++s) out += per_amount[s] * segment.amount[s];
  return out;
}

// Mean, change and variance of T(s) on a unit interval of amount, of which a is the first share fa.
// Change is 12 times the covariance with s: of a line, its rise.
GasSegment merged(const GasSegment& a, const GasSegment& b) {
  GasSegment out;
  out.start_m = a.start_m;
  out.end_m = b.end_m;
  out.weight = a.weight + b.weight;
  const double fa = out.weight > 0 ? a.weight / out.weight : 0.5, fb = 1 - fa;
  for (std::size_t s = 0; s < kPlumeSpecies; ++s) out.amount[s] = a.amount[s] + b.amount[s];
  out.pressure_pa = fa * a.pressure_pa + fb * b.pressure_pa;
  const double step_k = b.temperature_k - a.temperature_k;
  out.temperature_k = a.temperature_k + fb * step_k;
  out.temperature_change_k =
      6 * fa * fb * step_k + fa * fa * a.temperature_change_k + fb * fb * b.temperature_change_k;
  out.temperature_spread_k =
      std::sqrt(fa * a.temperature_spread_k * a.temperature_spread_k +
                fb * b.temperature_spread_k * b.temperature_spread_k + fa * fb * step_k * step_k);
  return out;
}

bool SegmentSteps::allow(double temperature_range, double optical_depth,
                         double composition_change) const {
  const double range = temperature_range * std::max(1.0, optical_depth / optical_depth_step);
  return range <= temperature_step &&
         range * composition_change <= temperature_step * composition_step;
}

void GasPiece::widen(const GasPiece& by) {
  least_k = std::min(least_k, by.least_k);
  most_k = std::max(most_k, by.most_k);
  for (std::size_t s = 0; s < kPlumeSpecies; ++s) {
    least_share[s] = std::min(least_share[s], by.least_share[s]);
    most_share[s] = std::max(most_share[s], by.most_share[s]);
  }
}

bool GasPiece::is_fine(const SegmentSteps& steps) const {
  double change = 0;
  for (std::size_t s = 0; s < kPlumeSpecies; ++s)
    change = std::max(change, most_share[s] - least_share[s]);
  return steps.allow(most_k / least_k - 1, steps.grey.optical_depth(segment), change);
}

void SegmentBuilder::add(const GasPiece& piece) {
  const GasSegment& next = piece.segment;
  if (!(next.weight > 0)) return;
  if (is_open_) {
    const GasSegment& last = open_.segment;
    const bool touches = next.start_m - last.end_m <= 1e-6 * (next.end_m - last.start_m);
    const bool same_pressure = std::abs(next.pressure_pa - first_pressure_pa_) <=
                               steps_.pressure_step * first_pressure_pa_;
    if (touches && same_pressure) {
      GasPiece both = open_;
      both.segment = merged(last, next);
      both.widen(piece);
      if (both.is_fine(steps_)) {
        open_ = both;
        return;
      }
    }
    out_.push_back(last);
  }
  open_ = piece;
  first_pressure_pa_ = next.pressure_pa;
  is_open_ = true;
}

std::vector<GasSegment> SegmentBuilder::take() {
  if (is_open_) out_.push_back(open_.segment);
  is_open_ = false;
  return std::move(out_);
}

std::vector<CoarseStep> coarser(const std::vector<GasSegment>& segments) {
  std::vector<CoarseStep> out;
  for (std::size_t i = 0; i < segments.size(); i += out.back().count) {
    const GasSegment& a = segments[i];
    if (i + 1 < segments.size()) {
      const GasSegment& b = segments[i + 1];
      // A straight line covers sqrt(12) standard deviations.
      const double course =
          std::sqrt(12) * std::max(a.temperature_spread_k, b.temperature_spread_k);
      if (std::abs(b.temperature_k - a.temperature_k) <= 2 * course) {
        out.push_back({merged(a, b), 2});
        continue;
      }
    }
    out.push_back({a, 1});
    out.back().segment.temperature_change_k = 0;
    out.back().segment.temperature_spread_k = 0;
  }
  return out;
}

}  // namespace irsig
