#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "view/rows/interpolate.h"

namespace irsig {

// The linear algebra behind interpolate.h.

// A symmetric positive definite matrix as its Cholesky factor.
class Cholesky {
 public:
  // Factors a row-major n x n matrix; only the lower triangle is read. Returns false if the matrix
  // is not positive definite.
  [[nodiscard]] bool factor(std::vector<double> matrix, std::size_t n);
  [[nodiscard]] std::vector<double> solve(std::vector<double> b) const;
  [[nodiscard]] std::vector<double> inverse() const;  // row-major: the bits of n calls of solve()
  [[nodiscard]] double log_determinant() const;

 private:
  std::size_t n_ = 0;
  std::vector<double> l_;
};

[[nodiscard]] inline double chord(Vec<Body> a, Vec<Body> b) { return length(a - b); }

// Returns the correlation of the field between two directions at this chord; 1 at distance 0.
[[nodiscard]] double covariance(const SphereKernel& kernel, double distance);

[[nodiscard]] double inner(const std::vector<double>& a, const std::vector<double>& b);

// C = K + diag(stderr^2) / s^2, factored, with the further quantities that ordinary kriging needs.
struct FactoredCovariance {
  Cholesky c;
  std::vector<double> c_inv_one;
  double one_c_inv_one;
  double trend;                    // m
  double variance;                 // s^2
  std::vector<double> noise;       // stderr^2 / s^2
  double negative_log_likelihood;  // restricted, up to a constant
};

// Factors the covariance of the samples. nullopt: two samples coincide.
[[nodiscard]] std::optional<FactoredCovariance> factor_covariance(const SphereSamples& samples,
                                                                  const SphereKernel& kernel);

}  // namespace irsig
