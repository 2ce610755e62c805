#include "core/materials/slope_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace irsig {
namespace {

// (1 - w^2) / ln(1/w^2), 1 at w = 1.
double cauchy_scale(double w2) {
  const double kappa = 1 - w2;
  return kappa < 1e-8 ? 1 - 0.5 * kappa : kappa / -std::log1p(-kappa);
}

}  // namespace

double half_vector_density(const SlopeLobe& lobe, double cos_h, double sin2_h) {
  const double w2 = lobe.width * lobe.width, cos2 = cos_h * cos_h;
  switch (lobe.law) {
    case SlopeLaw::kBeckmann:
      return std::exp(-sin2_h / (cos2 * w2)) / (std::numbers::pi * w2 * cos2 * cos_h);
    case SlopeLaw::kEllipsoid: {
      const double q = w2 * cos2 + sin2_h;
      return w2 * cos_h / (std::numbers::pi * q * q);
    }
    case SlopeLaw::kCauchy:
      return cauchy_scale(w2) / std::numbers::pi * cos_h / (w2 * cos2 + sin2_h);
  }
  return 0;
}

double largest_bell(double tan2, double w2, int power) {
  // Rises until 1 + t = power w2.
  const double t = std::max(tan2, power * w2 - 1);
  double bell = std::exp(-t / w2);
  for (int k = 0; k < power; ++k) bell *= 1 + t;
  return bell;
}

double open_grazing(const ReflectionRange& range) { return 0.25 / std::max(range.cos_o_min, 0.0); }

double groove_grazing(const ReflectionRange& range) {
  return std::min(open_grazing(range),
                  1 / (std::max(range.cos_i_min, 0.0) + std::max(range.cos_o_min, 0.0)));
}

double slope2_at(const SlopeLobe& lobe, double u) {
  const double w2 = lobe.width * lobe.width;
  switch (lobe.law) {
    case SlopeLaw::kBeckmann:
      return -w2 * std::log1p(-u);
    case SlopeLaw::kEllipsoid:
      return w2 * u / (1 - u);
    case SlopeLaw::kCauchy: {
      // v = w^2 cos^2 + sin^2 runs from w^2 to 1, uniform in its logarithm; sin^2 = (v - w^2) / (1
      // - w^2).
      const double kappa = 1 - w2, log_w2 = std::log(w2);
      const double sin2 = kappa < 1e-8 ? u : w2 * std::expm1(-u * log_w2) / kappa;
      return sin2 / (1 - sin2);
    }
  }
  return 0;
}

}  // namespace irsig
