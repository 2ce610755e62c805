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

namespace {

// Mean, change and variance of T(s) on a unit interval of amount, of which a is the first share fa.
// Change is 12 times the covariance with s: of a line, its rise.
void merge(const GasSegment& a, const GasSegment& b, GasSegment& out) {
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
  const double variance_a = a.temperature_spread_k * a.temperature_spread_k,
               variance_b = b.temperature_spread_k * b.temperature_spread_k;
  out.temperature_spread_k =
      std::sqrt(fa * variance_a + fb * variance_b + fa * fb * step_k * step_k);
  out.temperature_skew_k3 =
      fa * a.temperature_skew_k3 + fb * b.temperature_skew_k3 +
      fa * fb * step_k * (3 * (variance_b - variance_a) + (fa - fb) * step_k * step_k);
}

}  // namespace

GasSegment merged(const GasSegment& a, const GasSegment& b) {
  GasSegment out;
  merge(a, b, out);
  return out;
}

bool SegmentSteps::allow(double temperature_range, double optical_depth,
                         double composition_change) const {
  const double range = temperature_range * std::max(1.0, optical_depth / optical_depth_step);
  return range <= temperature_step &&
         range * composition_change <= temperature_step * composition_step;
}

void GasPiece::widen(const GasPiece& a, const GasPiece& b) {
  least_k = std::min(a.least_k, b.least_k);
  most_k = std::max(a.most_k, b.most_k);
  for (std::size_t s = 0; s < kPlumeSpecies; ++s) {
    least_fraction[s] = std::min(a.least_fraction[s], b.least_fraction[s]);
    most_fraction[s] = std::max(a.most_fraction[s], b.most_fraction[s]);
  }
}

TemperatureCourse course_of(const GasSegment& s) {
  constexpr double kFlat = 1e-5, kMiddle = 0.75;
  const double change = s.temperature_change_k,
               variance = s.temperature_spread_k * s.temperature_spread_k;
  TemperatureCourse out;
  out.is_flat = s.temperature_spread_k < kFlat * s.temperature_k;
  if (out.is_flat) return out;
  // Of a straight line 1; of a jump with shares p and 1 - p before and behind it 3 p (1 - p).
  const double straight = std::min(1.0, change * change / (12 * variance));
  if (straight >= kMiddle) {
    out.half_step_k = change * (2 + (straight - kMiddle) / (1 - kMiddle)) / 6;
    return out;
  }
  // A jump far from the middle, or a course that rises and falls: that is less skewed.
  const double off = std::sqrt(0.25 - straight / 3), full_step_k = 6 * variance / change,
               skew = straight / 3 * 2 * off * std::abs(full_step_k * full_step_k * full_step_k);
  if (std::abs(change) > kFlat * s.temperature_k && std::abs(s.temperature_skew_k3) > 0.5 * skew) {
    out.first += s.temperature_skew_k3 * change > 0 ? off : -off;
    out.half_step_k = 3 * variance / change;
  } else {
    out.half_step_k = 0.5 * change;
    out.is_known = false;
  }
  return out;
}

bool GasPiece::is_fine(const SegmentSteps& steps) const {
  constexpr double kRisesAndFalls = 4;
  double change = 0;
  for (std::size_t s = 0; s < kPlumeSpecies; ++s)
    change = std::max(change, most_fraction[s] - least_fraction[s]);
  const double range = most_k / least_k - 1;
  return steps.allow(course_of(segment).is_known ? range : kRisesAndFalls * range,
                     steps.grey.optical_depth(segment), change);
}

void SegmentBuilder::add(const GasPiece& piece) {
  const GasSegment& next = piece.segment;
  if (!(next.weight > 0)) return;
  if (is_open_) {
    const GasSegment& last = piece_[open_].segment;
    const bool touches = next.start_m - last.end_m <= 1e-6 * (next.end_m - last.start_m);
    const bool same_pressure = std::abs(next.pressure_pa - first_pressure_pa_) <=
                               steps_.pressure_step * first_pressure_pa_;
    if (touches && same_pressure) {
      // Made beside the open piece, which it replaces if it is fine: pieces are not copied.
      GasPiece& both = piece_[1 - open_];
      merge(last, next, both.segment);
      both.widen(piece_[open_], piece);
      if (both.is_fine(steps_)) {
        open_ = 1 - open_;
        return;
      }
    }
    out_.push_back(last);
  }
  piece_[open_] = piece;
  first_pressure_pa_ = next.pressure_pa;
  is_open_ = true;
}

std::vector<GasSegment> SegmentBuilder::take() {
  if (is_open_) out_.push_back(piece_[open_].segment);
  is_open_ = false;
  return std::move(out_);
}

std::vector<CoarseStep> coarser(const std::vector<GasSegment>& segments) {
  constexpr double kOffTheLine = 0.5;
  std::vector<CoarseStep> out;
  for (std::size_t i = 0; i < segments.size(); i += out.back().count) {
    const GasSegment& a = segments[i];
    if (i + 1 < segments.size()) {
      const GasSegment& b = segments[i + 1];
      // On one straight line the middles are as far apart as both changes say.
      const double of_a = a.temperature_change_k, of_b = b.temperature_change_k,
                   off = b.temperature_k - a.temperature_k - 0.5 * (of_a + of_b);
      if (of_a * of_b >= 0 &&
          std::abs(off) <= kOffTheLine * std::max(std::abs(of_a), std::abs(of_b))) {
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
