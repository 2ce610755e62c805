#include "core/spectral/planck.h"

#include <cmath>

#include "core/base/check.h"
#include "core/base/constants.h"
#include "core/spectral/planck_quadrature.h"

namespace irsig {
namespace {

// Above this exponent 1 - exp(-x) is 1 in double; expm1(x) overflows only at 709.8.
constexpr double kWienTail = 600.0;

// a exp(-x) where exp(-x) alone would underflow but the product does not: a is at most 1e100.
double times_exp_minus(double a, double x) {
  const double root = std::exp(-0.5 * x);
  return a * root * root;
}

void check_arguments(double lambda_um, double temperature_k) {
  IRSIG_CHECK(lambda_um >= kPlanckLambdaMinUm);
  IRSIG_CHECK(lambda_um <= kPlanckLambdaMaxUm);
  IRSIG_CHECK(temperature_k >= 0.0);
  IRSIG_CHECK(temperature_k <= kPlanckTemperatureMaxK);
}

double pow5(double x) { return x * x * x * x * x; }

}  // namespace

double planck_radiance_w_m2_sr_um(double lambda_um, double temperature_k) {
  check_arguments(lambda_um, temperature_k);
  const double x = kC2UmK / (lambda_um * temperature_k);  // +inf at 0 K
  const double scale = kC1LWUm4M2Sr / pow5(lambda_um);
  return x < kWienTail ? scale / std::expm1(x) : times_exp_minus(scale, x);
}

double planck_radiance_derivative_w_m2_sr_um_k(double lambda_um, double temperature_k) {
  check_arguments(lambda_um, temperature_k);
  const double x = kC2UmK / (lambda_um * temperature_k);
  if (x > kPlanckExponentMax) return 0.0;
  const double scale = kC1LWUm4M2Sr / pow5(lambda_um) * (x / temperature_k);
  const double one_minus_exp = -std::expm1(-x);
  return times_exp_minus(scale, x) / (one_minus_exp * one_minus_exp);
}

double planck_band_radiance_w_m2_sr(double lambda_min_um, double lambda_max_um,
                                    double temperature_k) {
  check_arguments(lambda_min_um, temperature_k);
  check_arguments(lambda_max_um, temperature_k);
  IRSIG_CHECK(lambda_min_um <= lambda_max_um);
  const PlanckIntegrals in = planck_integrals(lambda_min_um, lambda_max_um, temperature_k);
  return times_exp_minus(in.radiance_w_m2_sr, in.exponent);
}

double planck_band_radiance_derivative_w_m2_sr_k(double lambda_min_um, double lambda_max_um,
                                                 double temperature_k) {
  check_arguments(lambda_min_um, temperature_k);
  check_arguments(lambda_max_um, temperature_k);
  IRSIG_CHECK(lambda_min_um <= lambda_max_um);
  const PlanckIntegrals in = planck_integrals(lambda_min_um, lambda_max_um, temperature_k);
  return times_exp_minus(in.derivative_w_m2_sr_k, in.exponent);
}

}  // namespace irsig
