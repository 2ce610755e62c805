#include "core/thermal/sun_sine.h"

#include <gtest/gtest.h>

#include <random>

namespace irsig {
namespace {

// Rationale: crossings() leaves out positions of the sun that cannot matter. Expected: the same
// instants, to the last bit, as with all 24 samples and their bisection. Places up to the poles,
// from minutes to days, both levels that are asked for.
TEST(SunSine, SamplesThatAreLeftOutChangeNoCrossing) {
  std::mt19937_64 random(44);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  int found = 0;
  for (int round = 0; round < 120; ++round) {
    const bool polar = round % 4 == 0;
    const WeatherPlace place{.latitude_deg = polar ? between(65, 90) : between(-89, 89),
                             .longitude_deg = between(-180, 360),
                             .height_m = between(-100, 9000)};
    const double from = between(0, 3e9), length_s = round % 5 == 0   ? between(60, 3600)
                                                    : round % 5 == 1 ? between(3600, 172800)
                                                                     : 3600;
    const double level = round % 3 == 0 ? -0.1 : 0;
    const SunSine sine(place);
    std::vector<double> expected;
    const double to = from + length_s;
    const auto sample = [&](int i) { return i == 0 ? from : from + (to - from) * i / 24; };
    double before = sine.of(from) - level;
    for (int i = 1; i <= 24; ++i) {
      const double here = sine.of(sample(i)) - level;
      if ((before > 0) != (here > 0)) {
        double a = sample(i - 1), b = sample(i);
        for (int k = 0; k < 60; ++k) {
          const double middle = (a + b) / 2;
          if (middle <= a || middle >= b) break;
          ((sine.of(middle) > level) == (before > 0) ? a : b) = middle;
        }
        expected.push_back((a + b) / 2);
      }
      before = here;
    }
    EXPECT_EQ(sine.crossings(from, to, level), expected) << round;
    found += static_cast<int>(expected.size());
  }
  EXPECT_GT(found, 20);
}

}  // namespace
}  // namespace irsig
