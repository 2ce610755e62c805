#include "core/atmosphere/forward_scattering.h"

#include <algorithm>
#include <cmath>

namespace irsig {
namespace {

// Returns g^2 of the whole phase function.
double peak_fraction(double truncated) {
  const double g = truncated / (1 - truncated);
  return g * g;
}

}  // namespace

double peak_ratio(double truncated) {
  const double f = peak_fraction(truncated);
  return f / (1 - f);
}

TurnedOnce turned_once(double truncated, double peak_depth, double most) {
  constexpr double kThin = 1e-6;
  const double f = peak_fraction(truncated), second = truncated * truncated;
  if (f <= 0) return {1, truncated};
  const double x = std::max(peak_depth, kThin), p = (f - (1 - f) * second) / f;
  const double whole = -std::expm1(-x) / x * f + 1 - f;
  const double square =
      std::exp(-x) * std::expm1(x * p) / x * f + (1 - f) * second * std::exp(-x * (1 - p));
  return {whole / (1 - f), std::min(most, std::sqrt(square / whole))};
}

}  // namespace irsig
