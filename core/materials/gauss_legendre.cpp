#include "core/materials/gauss_legendre.h"

#include <cmath>
#include <numbers>

namespace irsig {

QuadratureRule gauss_legendre(int points) {
  constexpr double kPi = std::numbers::pi;
  QuadratureRule rule;
  for (int i = 0; i < points; ++i) {
    double x = std::cos(kPi * (i + 0.75) / (points + 0.5)), derivative = 1;
    for (int iteration = 0; iteration < 100; ++iteration) {
      double p0 = 1, p1 = x;
      for (int k = 2; k <= points; ++k) {
        const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1;
        p1 = p2;
      }
      derivative = points * (x * p1 - p0) / (x * x - 1);
      const double step = p1 / derivative;
      x -= step;
      if (std::abs(step) < 1e-15) break;
    }
    rule.x.push_back(0.5 * (1 - x));
    rule.w.push_back(1 / ((1 - x * x) * derivative * derivative));
  }
  return rule;
}

QuadratureRule gauss_legendre_between_roots(int points) {
  constexpr double kPi = std::numbers::pi;
  QuadratureRule rule = gauss_legendre(points);
  for (std::size_t i = 0; i < rule.x.size(); ++i) {
    const double t = kPi * rule.x[i];
    rule.x[i] = 0.5 * (1 - std::cos(t));
    rule.w[i] *= 0.5 * kPi * std::sin(t);
  }
  return rule;
}

}  // namespace irsig
