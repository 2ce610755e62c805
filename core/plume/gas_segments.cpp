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
  out.temperature_change_k = 6 * fa * fb * step_k + fa * fa * a.temperature_change_k +
                             fb * fb * b.temperature_change_k;
  out.temperature_spread_k =
      std::sqrt(fa * a.temperature_spread_k * a.temperature_spread_k +
                fb * b.temperature_spread_k * b.temperature_spread_k + fa * fb * step_k * step_k);
  return out;
}

namespace {

std::array<double, kPlumeSpecies> shares(const GasSegment& segment) {
  std::array<double, kPlumeSpecies> out{};
  for (std::size_t s = 0; s < kPlumeSpecies; ++s)
    out[s] = segment.amount[s] * (s == kSoot ? kSootMolPerM3 : 1) / segment.weight;
  return out;
}

}  // namespace

bool SegmentBuilder::belongs(const GasPiece& piece) const {
  const GasSegment &a = open_.segment, &b = piece.segment;
  if (b.start_m - a.end_m > 1e-6 * (b.end_m - a.start_m)) return false;  // empty in between
  const double least = std::min(open_.least_k, piece.least_k);
  const double most = std::max(open_.most_k, piece.most_k);
  const double depth = steps_.grey.optical_depth(a) + steps_.grey.optical_depth(b);
  const double thick = std::max(1.0, depth / steps_.optical_depth_step);
  if ((most / least - 1) * thick > steps_.temperature_step) return false;
  if (std::abs(b.pressure_pa - first_pressure_pa_) > steps_.pressure_step * first_pressure_pa_)
    return false;
  const auto share = shares(b);
  for (std::size_t s = 0; s < kPlumeSpecies; ++s)
    if (std::abs(share[s] - share_[s]) > steps_.composition_step) return false;
  return true;
}

void SegmentBuilder::add(const GasPiece& piece) {
  if (!(piece.segment.weight > 0)) return;
  if (is_open_ && belongs(piece)) {
    open_.segment = merged(open_.segment, piece.segment);
    open_.least_k = std::min(open_.least_k, piece.least_k);
    open_.most_k = std::max(open_.most_k, piece.most_k);
    return;
  }
  if (is_open_) out_.push_back(open_.segment);
  open_ = piece;
  share_ = shares(piece.segment);
  first_pressure_pa_ = piece.segment.pressure_pa;
  is_open_ = true;
}

std::vector<GasSegment> SegmentBuilder::take() {
  if (is_open_) out_.push_back(open_.segment);
  is_open_ = false;
  return std::move(out_);
}

std::vector<GasSegment> coarser(const std::vector<GasSegment>& segments) {
  std::vector<GasSegment> out;
  for (std::size_t i = 0; i < segments.size(); i += 2) {
    if (i + 1 < segments.size()) {
      out.push_back(merged(segments[i], segments[i + 1]));
    } else {
      out.push_back(segments[i]);
      out.back().temperature_change_k = 0;
      out.back().temperature_spread_k = 0;
    }
  }
  return out;
}

}  // namespace irsig
