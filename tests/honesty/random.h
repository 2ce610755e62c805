#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <numbers>
#include <random>

#include "core/geo/frames.h"

namespace irsig {

// Random draws the numbers of a scene from a seed. The same seed draws the same scene with every
// standard library, since no distribution of <random> is used.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  // Returns a number from low to high, uniform.
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  // Returns a number from low to high, both above 0, whose logarithm is uniform.
  double log_between(double low, double high) {
    return std::exp(between(std::log(low), std::log(high)));
  }
  // Returns a whole number from 0 to n - 1.
  template <std::integral Whole>
  Whole below(Whole n) {
    return std::min(static_cast<Whole>(n - 1),
                    static_cast<Whole>(between(0, static_cast<double>(n))));
  }
  // Returns a unit vector, uniform over the sphere.
  Vec<Body> direction() {
    const double z = between(-1, 1), turn = between(0, 2 * std::numbers::pi),
                 r = std::sqrt(1 - z * z);
    return {r * std::cos(turn), r * std::sin(turn), z};
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace irsig
