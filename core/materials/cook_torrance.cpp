#include "core/materials/cook_torrance.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/materials/fresnel.h"

namespace irsig {
namespace {

double smith_lambda(double cos_theta, double m) {
  if (cos_theta >= 1.0) return 0.0;
  const double a = cos_theta / (m * std::sqrt((1.0 - cos_theta) * (1.0 + cos_theta)));
  return 0.5 * -std::erfc(a) + std::exp(-a * a) / (2.0 * a * std::sqrt(std::numbers::pi));
}

}  // namespace

double smith_masking(double cos_i, double cos_o, double m) {
  return 1.0 / (1.0 + smith_lambda(cos_i, m) + smith_lambda(cos_o, m));
}

std::vector<double> fresnel_table(const OpticalConstant& constants, Fresnel form, int cells) {
  std::vector<double> table;
  for (int entry = 0; entry <= cells; ++entry) {
    const double x = static_cast<double>(entry) / cells, cos_d = x * x;
    table.push_back(form == Fresnel::kExact ? fresnel_exact(cos_d, constants.n, constants.k)
                                            : fresnel_schlick(cos_d, constants.n, constants.k));
  }
  return table;
}

double dot(const std::vector<double>& moments, const std::vector<double>& table) {
  return std::inner_product(moments.begin(), moments.end(), table.begin(), 0.0);
}

double v_groove_masking(const ReflectionGeometry& g) {
  return std::min(1.0, 2.0 * g.cos_h * std::min(g.cos_i, g.cos_o) / g.cos_d);
}

double cook_torrance_weight(const ReflectionGeometry& g, double m, Masking masking) {
  switch (masking) {
    case Masking::kVGroove:  // without cancellation at grazing
      return std::min(g.cos_d / (g.cos_o * g.cos_h), 2 * std::min(g.cos_i, g.cos_o) / g.cos_o);
    case Masking::kSmith:
      return smith_masking(g.cos_i, g.cos_o, m) * g.cos_d / (g.cos_o * g.cos_h);
    case Masking::kNone:
      return g.cos_d / (g.cos_o * g.cos_h);
  }
  return 0;
}

}  // namespace irsig
