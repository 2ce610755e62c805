#include "core/plume/gas_segments.h"

#include <algorithm>
#include <cmath>

#include "core/base/constants.h"

namespace irsig {
namespace {

// Factor by which a step is finer where its temperature may rise and fall.
constexpr double kRisesAndFalls = 4;

}  // namespace

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

TemperatureCourse course_of(const GasSegment& s) {
  constexpr double kFlat = 1e-5, kMiddle = 0.75;
  const double change = s.temperature_change_k,
               variance = s.temperature_spread_k * s.temperature_spread_k;
  TemperatureCourse out;
  out.is_flat = s.temperature_spread_k < kFlat * s.temperature_k;
  if (out.is_flat) return out;
  // The ratio is 1 for a straight line, and 3 p (1 - p) for a jump with shares p and 1 - p before
  // and behind it.
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
  double change = 0;
  for (std::size_t s = 0; s < kPlumeSpecies; ++s)
    change = std::max(change, most_fraction[s] - least_fraction[s]);
  const double range = most_k / least_k - 1, optical_depth = steps.grey.optical_depth(segment);
  if (!steps.allow(range, optical_depth, change)) return false;
  return steps.allow(kRisesAndFalls * range, optical_depth, change) || course_of(segment).is_known;
}

SegmentBuilder::Open SegmentBuilder::open(const GasPiece& piece, double from_k) {
  const GasSegment& s = piece.segment;
  const double off = s.temperature_k - from_k,
               variance = s.temperature_spread_k * s.temperature_spread_k;
  Open out;
  out.start_m = s.start_m;
  out.end_m = s.end_m;
  out.first_pressure_pa = s.pressure_pa;
  out.from_k = from_k;
  out.sums = {s.weight, s.weight * s.temperature_k, s.weight * s.pressure_pa, s.amount};
  out.first = s.weight * off;
  out.square = s.weight * (variance + off * off);
  out.cube = s.weight * (s.temperature_skew_k3 + 3 * off * variance + off * off * off);
  out.ordered = s.weight * s.weight * (s.temperature_change_k / 12 + 0.5 * off);
  out.least_k = piece.least_k;
  out.most_k = piece.most_k;
  out.least_fraction = piece.least_fraction;
  out.most_fraction = piece.most_fraction;
  return out;
}

GasPiece SegmentBuilder::closed(const Open& of) {
  GasPiece out{{}, of.least_k, of.most_k, of.least_fraction, of.most_fraction};
  GasSegment& s = out.segment;
  const double per_weight = 1 / of.sums.weight, off = of.first * per_weight,
               variance = std::max(0.0, of.square * per_weight - off * off);
  s.start_m = of.start_m;
  s.end_m = of.end_m;
  s.amount = of.sums.amount;
  s.weight = of.sums.weight;
  s.temperature_k = of.from_k + off;
  s.pressure_pa = of.sums.weight_pressure * per_weight;
  s.temperature_change_k = 12 * (of.ordered * per_weight * per_weight - 0.5 * off);
  s.temperature_spread_k = std::sqrt(variance);
  s.temperature_skew_k3 = of.cube * per_weight - 3 * off * variance - off * off * off;
  return out;
}

void SegmentBuilder::append(const Open& next, Open& to) {
  to.end_m = next.end_m;
  to.ordered += to.sums.weight * next.first + next.ordered;
  to.first += next.first;
  to.square += next.square;
  to.cube += next.cube;
  to.sums.weight += next.sums.weight;
  to.sums.weight_pressure += next.sums.weight_pressure;
  to.least_k = std::min(to.least_k, next.least_k);
  to.most_k = std::max(to.most_k, next.most_k);
  for (std::size_t s = 0; s < kPlumeSpecies; ++s) {
    to.sums.amount[s] += next.sums.amount[s];
    to.least_fraction[s] = std::min(to.least_fraction[s], next.least_fraction[s]);
    to.most_fraction[s] = std::max(to.most_fraction[s], next.most_fraction[s]);
  }
}

bool SegmentBuilder::continues(double start_m, double end_m, double pressure_pa) const {
  return is_open_ && start_m - open_.end_m <= 1e-6 * (end_m - open_.start_m) &&
         std::abs(pressure_pa - open_.first_pressure_pa) <=
             steps_.pressure_step * open_.first_pressure_pa;
}

void SegmentBuilder::add(const GasPiece& piece) {
  const GasSegment& next = piece.segment;
  if (!(next.weight > 0)) return;
  if (continues(next.start_m, next.end_m, next.pressure_pa)) {
    Open both = open_;
    append(open(piece, open_.from_k), both);
    if (closed(both).is_fine(steps_)) {
      open_ = both;
      return;
    }
  }
  if (is_open_) out_.push_back(closed(open_).segment);
  open_ = open(piece, next.temperature_k);
  is_open_ = true;
}

bool SegmentBuilder::extend(double a, const GasPoint& at_a, const GasPoint& at_middle, double b,
                            const GasPoint& at_b) {
  const GasSums &x = at_a.sums, &y = at_middle.sums, &z = at_b.sums;
  const double sixth = (b - a) / 6, weight = sixth * (x.weight + 4 * y.weight + z.weight);
  if (!is_open_ || !(weight > 0) || !at_middle.holds_gas) return false;
  const double per_weight = 1 / weight,
               weight_pressure =
                   sixth * (x.weight_pressure + 4 * y.weight_pressure + z.weight_pressure);
  if (!continues(a, b, weight_pressure * per_weight)) return false;
  // At an end without gas the temperature still has a value: as piece_of() has it.
  double t[] = {at_a.temperature_k - open_.from_k, at_middle.temperature_k - open_.from_k,
                at_b.temperature_k - open_.from_k};
  if (!at_a.holds_gas) t[0] = at_b.holds_gas ? 2 * t[1] - t[2] : t[1];
  if (!at_b.holds_gas) t[2] = 2 * t[1] - t[0];
  const double least_k = std::min(open_.least_k, open_.from_k + std::min({t[0], t[1], t[2]})),
               most_k = std::max(open_.most_k, open_.from_k + std::max({t[0], t[1], t[2]}));
  std::array<double, kPlumeSpecies> least = open_.least_fraction, most = open_.most_fraction;
  for (const GasPoint* point : {&at_a, &at_middle, &at_b}) {
    if (!point->holds_gas) continue;
    for (std::size_t k = 0; k < kPlumeSpecies; ++k) {
      least[k] = std::min(least[k], point->share[k]);
      most[k] = std::max(most[k], point->share[k]);
    }
  }
  GasSums sums = open_.sums;
  double depth = 0, change = 0;
  for (std::size_t k = 0; k < kPlumeSpecies; ++k) {
    sums.amount[k] += sixth * (x.amount[k] + 4 * y.amount[k] + z.amount[k]);
    depth += steps_.grey.per_amount[k] * sums.amount[k];
    change = std::max(change, most[k] - least[k]);
  }
  if (!steps_.allow(kRisesAndFalls * (most_k / least_k - 1), depth, change)) return false;
  const double w[] = {sixth * x.weight, 4 * sixth * y.weight, sixth * z.weight};
  const double first = w[0] * t[0] + w[1] * t[1] + w[2] * t[2],
               square = w[0] * t[0] * t[0] + w[1] * t[1] * t[1] + w[2] * t[2] * t[2],
               cube = w[0] * t[0] * t[0] * t[0] + w[1] * t[1] * t[1] * t[1] +
                      w[2] * t[2] * t[2] * t[2];
  // The middle's place in the weight: the share of the first half, of the parabola through all
  // three. Temperatures from their mean, as places of three points have a mean of their own.
  const double place = 0.25 * sixth * (5 * x.weight + 8 * y.weight - z.weight) * per_weight - 0.5,
               off = first * per_weight,
               change_k =
                   0.5 * (w[2] * (t[2] - off) - w[0] * (t[0] - off)) + w[1] * place * (t[1] - off);
  open_.ordered += open_.sums.weight * first + weight * (change_k + 0.5 * first);
  open_.first += first;
  open_.square += square;
  open_.cube += cube;
  open_.end_m = b;
  sums.weight += weight;
  sums.weight_pressure += weight_pressure;
  open_.sums = sums;
  open_.least_k = least_k;
  open_.most_k = most_k;
  open_.least_fraction = least;
  open_.most_fraction = most;
  return true;
}

std::vector<GasSegment> SegmentBuilder::take() {
  if (is_open_) out_.push_back(closed(open_).segment);
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
