#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/plume/gas_segments.h"

namespace irsig {

// A step over an interval of a ray with gas at its ends and middle known, halved until its
// temperature is nearly constant. Sums are those of Simpson's rule: exact where they are cubic in
// the distance.
template <typename Gas>
class IntervalMarcher {
 public:
  IntervalMarcher(const Gas& gas, const SegmentSteps& steps, SegmentBuilder& builder)
      : gas_(gas), steps_(steps), builder_(builder) {}

  void add(double a, const GasPoint& at_a, double b, const GasPoint& at_b) {
    add(a, at_a, b, at_b, GasPoint(gas_(0.5 * (a + b))), 0);
  }
  [[nodiscard]] std::uint64_t pieces() const { return pieces_; }

 private:
  static constexpr int kMostHalvings = 8;

  void add(double a, const GasPoint& at_a, double b, const GasPoint& at_b,
           const GasPoint& at_middle, int halvings) {
    if (builder_.extend(a, at_a, at_middle, b, at_b)) {
      ++pieces_;
      return;
    }
    const GasPiece piece = piece_of(a, at_a, at_middle, b, at_b);
    if (halvings < kMostHalvings && piece.segment.weight > 0 && !piece.is_fine(steps_)) {
      const double m = 0.5 * (a + b);
      add(a, at_a, m, at_middle, GasPoint(gas_(0.5 * (a + m))), halvings + 1);
      add(m, at_middle, b, at_b, GasPoint(gas_(0.5 * (m + b))), halvings + 1);
      return;
    }
    ++pieces_;
    builder_.add(piece);
  }

  static GasPiece piece_of(double a, const GasPoint& at_a, const GasPoint& at_m, double b,
                           const GasPoint& at_b) {
    const double sixth = (b - a) / 6;
    const GasSums &x = at_a.sums, &y = at_m.sums, &z = at_b.sums;
    const auto simpson = [sixth](double of_x, double of_y, double of_z) {
      return sixth * (of_x + 4 * of_y + of_z);
    };
    GasPiece out;
    GasSegment& s = out.segment;
    s.start_m = a;
    s.end_m = b;
    for (std::size_t k = 0; k < kPlumeSpecies; ++k)
      s.amount[k] = simpson(x.amount[k], y.amount[k], z.amount[k]);
    s.weight = simpson(x.weight, y.weight, z.weight);
    if (!(s.weight > 0)) return out;
    const double per_weight = 1 / s.weight;
    s.temperature_k =
        simpson(x.weight_temperature, y.weight_temperature, z.weight_temperature) * per_weight;
    s.pressure_pa = simpson(x.weight_pressure, y.weight_pressure, z.weight_pressure) * per_weight;
    // At an end without gas the temperature has no weight, but still has a value: the limit of the
    // temperature towards the end, which dominates the light of thick gas.
    double t[] = {at_a.temperature_k - s.temperature_k, at_m.temperature_k - s.temperature_k,
                  at_b.temperature_k - s.temperature_k};
    if (!at_m.holds_gas) t[1] = 0;
    if (!at_b.holds_gas) t[2] = 0;
    if (!at_a.holds_gas) t[0] = 2 * t[1] - t[2];
    if (!at_b.holds_gas) t[2] = 2 * t[1] - t[0];
    out.least_k = s.temperature_k + std::min({t[0], t[1], t[2], 0.0});
    out.most_k = s.temperature_k + std::max({t[0], t[1], t[2], 0.0});
    for (std::size_t k = 0; k < kPlumeSpecies; ++k)
      out.least_fraction[k] = out.most_fraction[k] =
          s.amount[k] * GasPoint::kWeightOfAmount[k] * per_weight;
    for (const GasPoint* end : {&at_a, &at_m, &at_b}) {
      if (!end->holds_gas) continue;
      for (std::size_t k = 0; k < kPlumeSpecies; ++k) {
        out.least_fraction[k] = std::min(out.least_fraction[k], end->share[k]);
        out.most_fraction[k] = std::max(out.most_fraction[k], end->share[k]);
      }
    }
    // Share of the amount in the first half: of the parabola through the three weights.
    const double relative = sixth * per_weight,
                 first = 0.25 * relative * (5 * x.weight + 8 * y.weight - z.weight);
    const double weight[] = {relative * x.weight, 4 * relative * y.weight, relative * z.weight};
    s.temperature_change_k =
        6 * (weight[2] * t[2] - weight[0] * t[0]) + 12 * weight[1] * (first - 0.5) * t[1];
    s.temperature_spread_k =
        std::sqrt(weight[0] * t[0] * t[0] + weight[1] * t[1] * t[1] + weight[2] * t[2] * t[2]);
    return out;
  }

  const Gas& gas_;
  const SegmentSteps& steps_;
  SegmentBuilder& builder_;
  std::uint64_t pieces_ = 0;
};

}  // namespace irsig
