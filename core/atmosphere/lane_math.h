#pragma once

#include <bit>
#include <cfloat>
#include <cstdint>

namespace irsig {

// exp and ln for loops over bands that the compiler turns into vectors (band_loops.cpp): no branch,
// no call, exactly rounded operations only, so the same bits on every processor and in every lane,
// unlike libm's.

// exp(x) for x <= 700: relative error below 4e-16 + 1e-16 |x|; 0 for x < -700.
// n = round(x / ln 2) is read off the low bits of x / ln 2 + 1.5 x 2^52; Taylor's series of degree
// 13 on +-ln(2) / 2 errs by 4e-18.
[[gnu::always_inline]] inline double exp_lane(double x) {
  constexpr double kRound = 6755399441055744.0;
  constexpr double kInverseLn2 = 1.4426950408889634;
  constexpr double kLn2High = 6.93147180369123816490e-01, kLn2Low = 1.90821492927058770002e-10;
  const double bounded = x >= -700.0 ? x : 0.0;
  const double shifted = bounded * kInverseLn2 + kRound;
  const double n = shifted - kRound;
  const double r = (bounded - n * kLn2High) - n * kLn2Low;
  double sum = r * (1.0 / 6227020800) + 1.0 / 479001600;
  sum = sum * r + 1.0 / 39916800;
  sum = sum * r + 1.0 / 3628800;
  sum = sum * r + 1.0 / 362880;
  sum = sum * r + 1.0 / 40320;
  sum = sum * r + 1.0 / 5040;
  sum = sum * r + 1.0 / 720;
  sum = sum * r + 1.0 / 120;
  sum = sum * r + 1.0 / 24;
  sum = sum * r + 1.0 / 6;
  sum = sum * r + 0.5;
  sum = sum * r + 1.0;
  sum = sum * r + 1.0;
  const double scaled =
      sum * std::bit_cast<double>((std::bit_cast<std::uint64_t>(shifted) + 1023) << 52);
  return x >= -700.0 ? scaled : 0.0;
}

// ln(x) for DBL_MIN <= x < infinity; below, ln(DBL_MIN). Error below one unit in the last place,
// also next to 1.
// x = 2^k m with m in [sqrt(1/2), sqrt(2)), s = (m - 1) / (m + 1), ln m = 2 artanh s; the series
// to s^21 errs by 1e-18.
[[gnu::always_inline]] inline double ln_lane(double x) {
  constexpr std::uint64_t kSqrtHalf = 0x3fe6a09e667f3bcd, kBias = std::uint64_t{1024} << 52;
  constexpr double kLn2High = 6.93147180369123816490e-01, kLn2Low = 1.90821492927058770002e-10;
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(x > DBL_MIN ? x : DBL_MIN);
  const std::uint64_t biased = (bits - kSqrtHalf + kBias) >> 52;  // k + 1024
  const double k = std::bit_cast<double>(biased | std::uint64_t{0x4330000000000000}) -
                   (4503599627370496.0 + 1024);
  const double f = std::bit_cast<double>(bits - (biased << 52) + kBias) - 1.0;
  const double s = f / (2.0 + f), z = s * s;
  double sum = z * (1.0 / 21) + 1.0 / 19;
  sum = sum * z + 1.0 / 17;
  sum = sum * z + 1.0 / 15;
  sum = sum * z + 1.0 / 13;
  sum = sum * z + 1.0 / 11;
  sum = sum * z + 1.0 / 9;
  sum = sum * z + 1.0 / 7;
  sum = sum * z + 1.0 / 5;
  sum = sum * z + 1.0 / 3;
  return k * kLn2High + (f - (s * (f - 2.0 * (z * sum)) - k * kLn2Low));
}

// exp(x) and exp(x) - 1 together, each with its own digits: relative errors below 6e-16 + 1e-16 |x|
// for |x| <= 700; beyond, those of +-700. exp(x) - 1 = 2^n (exp(r) - 1) + (2^n - 1): the second
// summand is exact, and of the first's sign or larger by a factor of 1.4.
struct ExpLane {
  double exp, exp_minus_1;
};
[[gnu::always_inline]] inline ExpLane expm1_lane(double x) {
  constexpr double kRound = 6755399441055744.0;
  constexpr double kInverseLn2 = 1.4426950408889634;
  constexpr double kLn2High = 6.93147180369123816490e-01, kLn2Low = 1.90821492927058770002e-10;
  const double above = x >= -700.0 ? x : -700.0;
  const double bounded = above <= 700.0 ? above : 700.0;
  const double shifted = bounded * kInverseLn2 + kRound;
  const double n = shifted - kRound;
  const double r = (bounded - n * kLn2High) - n * kLn2Low;
  double sum = r * (1.0 / 87178291200) + 1.0 / 6227020800;
  sum = sum * r + 1.0 / 479001600;
  sum = sum * r + 1.0 / 39916800;
  sum = sum * r + 1.0 / 3628800;
  sum = sum * r + 1.0 / 362880;
  sum = sum * r + 1.0 / 40320;
  sum = sum * r + 1.0 / 5040;
  sum = sum * r + 1.0 / 720;
  sum = sum * r + 1.0 / 120;
  sum = sum * r + 1.0 / 24;
  sum = sum * r + 1.0 / 6;
  sum = sum * r + 0.5;
  const double part = r + r * r * sum;
  const double scale = std::bit_cast<double>((std::bit_cast<std::uint64_t>(shifted) + 1023) << 52);
  return {scale + scale * part, scale * part + (scale - 1.0)};
}

// ln(1 + x) for x > -1: relative error below 1e-15 also next to 0.
[[gnu::always_inline]] inline double log1p_lane(double x) {
  const double sum = 1.0 + x, seen = sum - 1.0;
  const bool lost = seen == 0.0;
  // Rounding changes x and its logarithm by the same factor.
  return lost ? x : ln_lane(sum) * (x / (lost ? 1.0 : seen));
}

}  // namespace irsig
