#include "core/thermal/sun_sine.h"

#include <array>
#include <cmath>

#include "core/base/constants.h"

namespace irsig {

double SunSine::of(double unix_s) const {
  const auto sun =
      sun_position(utc_time(unix_s), place_.latitude_deg, place_.longitude_deg, place_.height_m);
  return sun.ok() ? std::cos(sun->zenith_deg * kRadPerDeg) : -1;
}

std::vector<double> SunSine::crossings(double from, double to, double level) const {
  // A bound on the rate of the sine: the Earth's rotation, and one percent for the sun's own motion
  // and parallax. A leap second moves the sine by less than the slack.
  constexpr double kFastestPerS = 7.4e-5, kSlack = 1e-4;
  std::vector<double> out;
  constexpr int kSamples = 24;
  const auto sample = [&](int i) { return i == 0 ? from : from + (to - from) * i / kSamples; };
  double at_a = of(from) - level, seen_at = from;
  for (int i = 1; i <= kSamples; ++i) {
    // Too early for another sign than that of the last position that was computed.
    if (kFastestPerS * (sample(i) - seen_at) + kSlack < std::abs(at_a)) continue;
    const double b = sample(i), at_b = of(b) - level;
    if ((at_a > 0) != (at_b > 0)) out.push_back(root(sample(i - 1), b, at_a > 0, level));
    seen_at = b;
    at_a = at_b;
  }
  return out;
}

SunSine::Above SunSine::above(double from, double to, double level) const {
  constexpr std::array<double, 3> kNode = {0, 0.5384693101056831, 0.9061798459386640};
  constexpr std::array<double, 3> kWeight = {0.5688888888888889, 0.4786286704993665,
                                             0.2369268850561891};
  std::vector<double> edge = crossings(from, to, level);
  edge.insert(edge.begin(), from);
  edge.push_back(to);
  Above out;
  for (std::size_t i = 1; i < edge.size(); ++i) {
    const double middle = (edge[i] + edge[i - 1]) / 2, half = (edge[i] - edge[i - 1]) / 2;
    if (half <= 0 || of(middle) <= level) continue;
    out.length_s += 2 * half;
    double sum = kWeight[0] * (of(middle) - level);
    for (std::size_t k = 1; k < kNode.size(); ++k)
      sum += kWeight[k] * (of(middle - half * kNode[k]) + of(middle + half * kNode[k]) - 2 * level);
    out.integral_s += half * sum;
  }
  return out;
}

double SunSine::root(double a, double b, bool falls, double level) const {
  for (int i = 0; i < 60; ++i) {
    const double middle = (a + b) / 2;
    if (middle <= a || middle >= b) break;
    ((of(middle) > level) == falls ? a : b) = middle;
  }
  return (a + b) / 2;
}

}  // namespace irsig
