#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/check.h"
#include "core/base/constants.h"
#include "core/spectral/planck.h"
#include "core/spectral/planck_quadrature.h"

namespace irsig {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// The temperature at which L_b(lambda_um, T) = exp(log_radiance): the logarithm keeps radiances
// that are near the smallest double apart from zero.
double temperature_of_log_k(double lambda_um, double log_radiance) {
  // exp(x) = 1 + exp(z)
  const double z = std::log(kC1LWUm4M2Sr) - 5.0 * std::log(lambda_um) - log_radiance;
  const double x = z > 40.0 ? z : std::log1p(std::exp(z));
  return kC2UmK / (lambda_um * x);
}

}  // namespace

double monochromatic_temperature_k(double lambda_um, double spectral_radiance_w_m2_sr_um) {
  IRSIG_CHECK(lambda_um >= kPlanckLambdaMinUm);
  IRSIG_CHECK(lambda_um <= kPlanckLambdaMaxUm);
  if (!(spectral_radiance_w_m2_sr_um >= 0.0)) return kNone;
  if (spectral_radiance_w_m2_sr_um == 0.0) return 0.0;
  if (spectral_radiance_w_m2_sr_um > planck_radiance_w_m2_sr_um(lambda_um, kPlanckTemperatureMaxK))
    return kNone;
  return temperature_of_log_k(lambda_um, std::log(spectral_radiance_w_m2_sr_um));
}

// Newton's iteration for ln L(1/T) = ln radiance. ln L is the logarithm of a sum (over wavelengths
// and over the terms of the geometric series) of exponentials of 1/T, hence convex in 1/T: from a
// start at or above the solution every step stays above it and no bracket is needed.
//
// The start: at the solution some wavelength of the band has exactly the mean spectral radiance.
// The temperature that has it is, as a function of wavelength, highest at one of the edges, because
// L_b is unimodal.
double radiance_temperature_k(double lambda_min_um, double lambda_max_um, double radiance_w_m2_sr) {
  IRSIG_CHECK(lambda_min_um >= kPlanckLambdaMinUm);
  IRSIG_CHECK(lambda_max_um <= kPlanckLambdaMaxUm);
  IRSIG_CHECK(lambda_min_um < lambda_max_um);
  if (!(radiance_w_m2_sr >= 0.0)) return kNone;
  if (radiance_w_m2_sr == 0.0) return 0.0;
  if (radiance_w_m2_sr >
      planck_band_radiance_w_m2_sr(lambda_min_um, lambda_max_um, kPlanckTemperatureMaxK))
    return kNone;
  const double log_target = std::log(radiance_w_m2_sr);
  const double log_mean = log_target - std::log(lambda_max_um - lambda_min_um);
  double temperature_k = std::max(temperature_of_log_k(lambda_min_um, log_mean),
                                  temperature_of_log_k(lambda_max_um, log_mean));
  constexpr int kMostSteps = 200;  // 20 suffice for 1e-3 to 1e9 um, 1e-300 to 1e30 W/(m2 sr)
  for (int step = 0; step < kMostSteps; ++step) {
    const PlanckIntegrals in = planck_integrals(lambda_min_um, lambda_max_um, temperature_k);
    if (!(in.radiance_w_m2_sr > 0.0)) return kNone;
    const double log_ratio = std::log(in.radiance_w_m2_sr) - in.exponent - log_target;
    const double relative_step =
        log_ratio * in.radiance_w_m2_sr / (temperature_k * in.derivative_w_m2_sr_k);
    temperature_k /= 1.0 + relative_step;
    // Convergence is quadratic: the step after this one would be below the last bit.
    if (std::abs(relative_step) < 1e-9) return temperature_k;
  }
  return kNone;
}

}  // namespace irsig
