#include "core/gas/soot.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace irsig {

double soot_absorption_per_m(double wavenumber_cm1) {
  // Beyond 30 um the cubics of the index run away; its value there is kept.
  const double lambda_um = 1e4 / wavenumber_cm1, ln = std::log(std::min(lambda_um, 30.0));
  const double n = 1.811 + ln * (0.1263 + ln * (0.0270 + ln * 0.0417));
  const double k = 0.5821 + ln * (0.1213 + ln * (0.2309 - ln * 0.0100));
  const double real = n * n - k * k + 2, imaginary = 2 * n * k;
  return 36e6 * std::numbers::pi * n * k / (lambda_um * (real * real + imaginary * imaginary));
}

}  // namespace irsig
