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

GasPiece GasPiece::between(double a, const GasPoint& at_a, const GasPoint& at_middle, double b,
                           const GasPoint& at_b) {
  const GasSums &x = at_a.sums, &y = at_middle.sums, &z = at_b.sums;
  const double sixth = (b - a) / 6;
  const auto simpson = [sixth](double of_x, double of_y, double of_z) {
    return sixth * (of_x + 4 * of_y + of_z);
  };
  GasPiece out;
  out.start_m = a;
  out.end_m = b;
  out.sums.weight = simpson(x.weight, y.weight, z.weight);
  if (!(out.sums.weight > 0)) return out;
  const GasPoint& known = at_middle.holds_gas ? at_middle : at_a.holds_gas ? at_a : at_b;
  out.from_k = known.temperature_k;
  out.sums.weight_temperature =
      simpson(x.weight_temperature, y.weight_temperature, z.weight_temperature);
  out.sums.weight_pressure = simpson(x.weight_pressure, y.weight_pressure, z.weight_pressure);
  for (std::size_t k = 0; k < kPlumeSpecies; ++k)
    out.sums.amount[k] = simpson(x.amount[k], y.amount[k], z.amount[k]);
  // At an end without gas the temperature has no weight, but still has a value: the limit of the
  // temperature towards the end, which dominates the light of thick gas.
  double t[3];
  const GasPoint* point[] = {&at_a, &at_middle, &at_b};
  out.least_fraction = out.most_fraction = known.share;
  for (int i = 0; i < 3; ++i) {
    t[i] = point[i]->holds_gas ? point[i]->temperature_k - out.from_k : 0;
    if (!point[i]->holds_gas) continue;
    for (std::size_t k = 0; k < kPlumeSpecies; ++k) {
      out.least_fraction[k] = std::min(out.least_fraction[k], point[i]->share[k]);
      out.most_fraction[k] = std::max(out.most_fraction[k], point[i]->share[k]);
    }
  }
  if (!at_a.holds_gas) t[0] = 2 * t[1] - t[2];
  if (!at_b.holds_gas) t[2] = 2 * t[1] - t[0];
  out.least_k = out.from_k + std::min({t[0], t[1], t[2]});
  out.most_k = out.from_k + std::max({t[0], t[1], t[2]});
  const double w[] = {sixth * x.weight, 4 * sixth * y.weight, sixth * z.weight};
  for (int i = 0; i < 3; ++i) {
    out.first += w[i] * t[i];
    out.square += w[i] * t[i] * t[i];
    out.cube += w[i] * t[i] * t[i] * t[i];
  }
  // The weight in front of the middle is that of the parabola through all three. Temperatures from
  // their mean, as the places of three points have a mean of their own.
  const double weight = out.sums.weight, off = out.first / weight,
               front = 0.25 * sixth * (5 * x.weight + 8 * y.weight - z.weight);
  out.ordered = 0.5 * weight * (w[2] * (t[2] - off) - w[0] * (t[0] - off)) +
                w[1] * (front - 0.5 * weight) * (t[1] - off) + 0.5 * weight * out.first;
  return out;
}

void GasPiece::append(const GasPiece& next) {
  // From this piece's temperature: (T - from) = (T - next.from) + d.
  const double d = next.from_k - from_k, weight = next.sums.weight;
  const double of_next = next.first + d * weight;
  ordered += sums.weight * of_next + next.ordered + 0.5 * d * weight * weight;
  first += of_next;
  square += next.square + d * (2 * next.first + d * weight);
  cube += next.cube + d * (3 * next.square + d * (3 * next.first + d * weight));
  end_m = next.end_m;
  sums.weight += weight;
  sums.weight_temperature += next.sums.weight_temperature;
  sums.weight_pressure += next.sums.weight_pressure;
  least_k = std::min(least_k, next.least_k);
  most_k = std::max(most_k, next.most_k);
  for (std::size_t s = 0; s < kPlumeSpecies; ++s) {
    sums.amount[s] += next.sums.amount[s];
    least_fraction[s] = std::min(least_fraction[s], next.least_fraction[s]);
    most_fraction[s] = std::max(most_fraction[s], next.most_fraction[s]);
  }
}

GasSegment GasPiece::segment() const {
  GasSegment s;
  const double per_weight = 1 / sums.weight, off = first * per_weight,
               variance = std::max(0.0, square * per_weight - off * off);
  s.start_m = start_m;
  s.end_m = end_m;
  s.amount = sums.amount;
  s.weight = sums.weight;
  s.temperature_k = from_k + off;
  s.pressure_pa = pressure_pa();
  s.temperature_change_k = 12 * (ordered * per_weight * per_weight - 0.5 * off);
  s.temperature_spread_k = std::sqrt(variance);
  s.temperature_skew_k3 = cube * per_weight - 3 * off * variance - off * off * off;
  return s;
}

bool GasPiece::is_fine(const SegmentSteps& steps) const {
  double change = 0, depth = 0;
  for (std::size_t s = 0; s < kPlumeSpecies; ++s) {
    change = std::max(change, most_fraction[s] - least_fraction[s]);
    depth += steps.grey.per_amount[s] * sums.amount[s];
  }
  const double range = most_k / least_k - 1;
  if (!steps.allow(range, depth, change)) return false;
  return steps.allow(kRisesAndFalls * range, depth, change) || course_of(segment()).is_known;
}

bool SegmentBuilder::continues(const GasPiece& next) const {
  return is_open_ && next.start_m - open_.end_m <= 1e-6 * (next.end_m - open_.start_m) &&
         std::abs(next.pressure_pa() - first_pressure_pa_) <=
             steps_.pressure_step * first_pressure_pa_;
}

void SegmentBuilder::add(const GasPiece& piece) {
  if (!(piece.sums.weight > 0)) return;
  if (continues(piece)) {
    GasPiece both = open_;
    both.append(piece);
    if (both.is_fine(steps_)) {
      open_ = both;
      return;
    }
  }
  if (is_open_) out_.push_back(open_.segment());
  open_ = piece;
  first_pressure_pa_ = piece.pressure_pa();
  is_open_ = true;
}

std::vector<GasSegment> SegmentBuilder::take() {
  if (is_open_) out_.push_back(open_.segment());
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
