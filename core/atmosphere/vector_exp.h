#pragma once

#include <cstdint>

namespace irsig {

// Two doubles at once with what every x86-64 and ARMv8 has (GCC and Clang lower it elsewhere): the
// same bits on all of them, unlike libm's.
using Pair = double __attribute__((vector_size(16)));
using PairBits = std::int64_t __attribute__((vector_size(16)));

// exp(x) for x <= 700: relative error below 4e-16 + 1e-16 |x|; 0 for x < -700.
// n = round(x / ln 2) is read off the low bits of x / ln 2 + 1.5 x 2^52; Taylor's series of degree
// 13 on
// +-ln(2) / 2 errs by 4e-18.
inline Pair exp_pair(Pair x) {
  constexpr double kRound = 6755399441055744.0;
  constexpr double kInverseLn2 = 1.4426950408889634;
  constexpr double kLn2High = 6.93147180369123816490e-01, kLn2Low = 1.90821492927058770002e-10;
  const PairBits live = x >= -700.0;
  const Pair bounded = reinterpret_cast<Pair>(reinterpret_cast<PairBits>(x) & live);
  const Pair shifted = bounded * kInverseLn2 + kRound;
  const Pair n = shifted - kRound;
  const Pair r = (bounded - n * kLn2High) - n * kLn2Low;
  Pair sum = r * (1.0 / 6227020800) + 1.0 / 479001600;
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
  const Pair scale = reinterpret_cast<Pair>((reinterpret_cast<PairBits>(shifted) + 1023) << 52);
  return reinterpret_cast<Pair>(reinterpret_cast<PairBits>(sum * scale) & live);
}

}  // namespace irsig
