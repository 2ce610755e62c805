#include "core/materials/fresnel.h"

#include <complex>

namespace irsig {

double fresnel_exact(double cos_theta, double n, double k) {
  const std::complex<double> index(n, k);
  const double sin2 = 1.0 - cos_theta * cos_theta;
  const std::complex<double> root = std::sqrt(index * index - sin2);  // n cos(theta_t)
  const std::complex<double> s = (cos_theta - root) / (cos_theta + root);
  const std::complex<double> p =
      (index * index * cos_theta - root) / (index * index * cos_theta + root);
  return 0.5 * (std::norm(s) + std::norm(p));
}

double fresnel_schlick(double cos_theta, double n, double k) {
  const double f0 = ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k);
  const double x = 1.0 - cos_theta;
  return f0 + (1.0 - f0) * x * x * x * x * x;
}

}  // namespace irsig
