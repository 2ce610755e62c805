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
    const GasPiece piece = GasPiece::between(a, at_a, at_middle, b, at_b);
    if (halvings < kMostHalvings && piece.sums.weight > 0 && !piece.is_fine(steps_)) {
      const double m = 0.5 * (a + b);
      add(a, at_a, m, at_middle, GasPoint(gas_(0.5 * (a + m))), halvings + 1);
      add(m, at_middle, b, at_b, GasPoint(gas_(0.5 * (m + b))), halvings + 1);
      return;
    }
    ++pieces_;
    builder_.add(piece);
  }

  const Gas& gas_;
  const SegmentSteps& steps_;
  SegmentBuilder& builder_;
  std::uint64_t pieces_ = 0;
};

}  // namespace irsig
