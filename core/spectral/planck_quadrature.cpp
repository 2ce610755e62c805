#include "core/spectral/planck_quadrature.h"

#include <algorithm>
#include <cmath>

#include "core/base/constants.h"

namespace irsig {
namespace {

struct Node {
  double abscissa;
  double weight;
};

// Gauss-Legendre, 12 points on [-1, 1], the positive half. (Computed with 50 digits.)
constexpr Node kGauss12[] = {
    {0.12523340851146891547, 0.24914704581340278500},
    {0.36783149899818019375, 0.23349253653835480876},
    {0.58731795428661744730, 0.20316742672306592175},
    {0.76990267419430468704, 0.16007832854334622633},
    {0.90411725637047485668, 0.10693932599531843096},
    {0.98156063424671925069, 0.04717533638651182719},
};

// In x = c2 / (lambda T) the integrands are exp(-x) times x^3 / (1 - exp(-x)) and x^4 / (1 -
// exp(-x))^2, with their nearest poles at +-2 pi i. Against panels of width 1, over 0.01 um to 1e10
// um and 1 to 1e6 K: width 4 and less 4e-15 (rounding), 6: 1e-14, 8: 3e-12, 12: 9e-10.
constexpr double kPanelWidth = 4.0;

// Beyond this distance above the lower limit the integrand adds less than 1e-19 of the integral.
constexpr double kNegligible = 60.0;

}  // namespace

// L      = c1L T^4 / c2^4  integral of x^3 exp(-x) / (1 - exp(-x)) dx
// dL/dT  = c1L T^3 / c2^4  integral of x^4 exp(-x) / (1 - exp(-x))^2 dx,  over [x(lambda_max),
// x(lambda_min)]. The integration variable is t = x - x(lambda_max): no two large numbers are
// subtracted, however narrow the band is and however small its radiance.
PlanckIntegrals planck_integrals(double lambda_min_um, double lambda_max_um, double temperature_k) {
  const double exponent = kC2UmK / (lambda_max_um * temperature_k);
  if (!(exponent <= kPlanckExponentMax)) return {0.0, 0.0, 0.0};
  const double width =
      exponent * (lambda_max_um - lambda_min_um) / lambda_min_um;  // x(lambda_min) - x(lambda_max)
  const double length = std::min(width, kNegligible);
  const double panels = std::max(1.0, std::ceil(length / kPanelWidth));
  const double half = 0.5 * length / panels;
  double cubic = 0.0;
  double quartic = 0.0;
  for (double panel = 0.0; panel < panels; panel += 1.0) {
    const double middle = (2.0 * panel + 1.0) * half;
    for (const Node& node : kGauss12) {
      for (const double side : {-node.abscissa, node.abscissa}) {
        const double t = middle + side * half;
        const double x = exponent + t;
        const double ratio = x / -std::expm1(-x);
        const double term = node.weight * std::exp(-t) * x * x * ratio;
        cubic += term;
        quartic += term * ratio;
      }
    }
  }
  const double t3 = temperature_k * temperature_k * temperature_k;
  const double scale = kC1LWUm4M2Sr / (kC2UmK * kC2UmK * kC2UmK * kC2UmK) * t3 * half;
  return {exponent, scale * temperature_k * cubic, scale * quartic};
}

}  // namespace irsig
