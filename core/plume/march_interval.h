#pragma once

#include <algorithm>
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

  void add(double a, const GasSums& at_a, double b, const GasSums& at_b) {
    add(a, at_a, b, at_b, gas_(0.5 * (a + b)), 0);
  }
  [[nodiscard]] std::uint64_t pieces() const { return pieces_; }

 private:
  static constexpr int kMostHalvings = 8;

  void add(double a, const GasSums& at_a, double b, const GasSums& at_b, const GasSums& at_middle,
           int halvings) {
    const GasPiece piece = piece_of(a, at_a, at_middle, b, at_b);
    if (halvings < kMostHalvings && piece.segment.weight > 0 && !piece.is_fine(steps_)) {
      const double m = 0.5 * (a + b);
      add(a, at_a, m, at_middle, gas_(0.5 * (a + m)), halvings + 1);
      add(m, at_middle, b, at_b, gas_(0.5 * (m + b)), halvings + 1);
      return;
    }
    ++pieces_;
    builder_.add(piece);
  }

  static double share(std::size_t species, double amount, double per_weight) {
    return amount * (species == kSoot ? kSootMolPerM3 : 1) * per_weight;
  }

  static GasPiece piece_of(double a, const GasSums& at_a, const GasSums& at_m, double b,
                           const GasSums& at_b) {
    const double length = b - a;
    const auto simpson = [&](double x, double y, double z) { return length / 6 * (x + 4 * y + z); };
    GasPiece out;
    GasSegment& s = out.segment;
    s.start_m = a;
    s.end_m = b;
    for (std::size_t k = 0; k < kPlumeSpecies; ++k)
      s.amount[k] = simpson(at_a.amount[k], at_m.amount[k], at_b.amount[k]);
    s.weight = simpson(at_a.weight, at_m.weight, at_b.weight);
    if (!(s.weight > 0)) return out;
    s.temperature_k =
        simpson(at_a.weight_temperature, at_m.weight_temperature, at_b.weight_temperature) /
        s.weight;
    s.pressure_pa =
        simpson(at_a.weight_pressure, at_m.weight_pressure, at_b.weight_pressure) / s.weight;
    // At an end without gas the temperature has no weight, but still has a value: the limit of the
    // temperature towards the end, which dominates the light of thick gas.
    const GasSums* ends[] = {&at_a, &at_m, &at_b};
    double t[3], weight[3];
    out.least_k = out.most_k = s.temperature_k;
    const double per_weight = 1 / s.weight;
    for (std::size_t k = 0; k < kPlumeSpecies; ++k)
      out.least_fraction[k] = out.most_fraction[k] = share(k, s.amount[k], per_weight);
    for (int i = 0; i < 3; ++i) {
      weight[i] = (i == 1 ? 4.0 : 1.0) / 6 * ends[i]->weight * length / s.weight;
      t[i] =
          ends[i]->weight > 0 ? ends[i]->weight_temperature / ends[i]->weight - s.temperature_k : 0;
    }
    if (!(at_a.weight > 0)) t[0] = 2 * t[1] - t[2];
    if (!(at_b.weight > 0)) t[2] = 2 * t[1] - t[0];
    for (int i = 0; i < 3; ++i) {
      out.least_k = std::min(out.least_k, s.temperature_k + t[i]);
      out.most_k = std::max(out.most_k, s.temperature_k + t[i]);
      if (!(ends[i]->weight > 0)) continue;
      const double per_own = 1 / ends[i]->weight;
      for (std::size_t k = 0; k < kPlumeSpecies; ++k) {
        const double own = share(k, ends[i]->amount[k], per_own);
        out.least_fraction[k] = std::min(out.least_fraction[k], own);
        out.most_fraction[k] = std::max(out.most_fraction[k], own);
      }
    }
    // Share of the amount in the first half: of the parabola through the three weights.
    const double first = length / 24 * (5 * at_a.weight + 8 * at_m.weight - at_b.weight) / s.weight;
    const double place[] = {-0.5, first - 0.5, 0.5};
    double change = 0, variance = 0;
    for (int i = 0; i < 3; ++i) {
      change += 12 * weight[i] * place[i] * t[i];
      variance += weight[i] * t[i] * t[i];
    }
    s.temperature_change_k = change;
    s.temperature_spread_k = std::sqrt(variance);
    return out;
  }

  const Gas& gas_;
  const SegmentSteps& steps_;
  SegmentBuilder& builder_;
  std::uint64_t pieces_ = 0;
};

}  // namespace irsig
