#pragma once

namespace irsig {

// Beyond this exponent every Planck quantity underflows for the arguments that planck.h accepts.
inline constexpr double kPlanckExponentMax = 1500.0;

// Band radiance and its derivative with exp(-exponent) taken out, so that they do not underflow:
// L = radiance exp(-exponent). All three are 0 where the true values underflow.
struct PlanckIntegrals {
  double exponent;  // c2 / (lambda_max T)
  double radiance_w_m2_sr;
  double derivative_w_m2_sr_k;  // with respect to temperature
};

[[nodiscard]] PlanckIntegrals planck_integrals(double lambda_min_um, double lambda_max_um,
                                               double temperature_k);

}  // namespace irsig
