#include "view/rows/kriging.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace irsig {
namespace {

// Added to the diagonal: keeps the Cholesky factor real for lengths of many spacings. It smooths by
// 1e-10 of the field's variance.
constexpr double kJitter = 1e-10;

}  // namespace

double covariance(const SphereKernel& kernel, double distance) {
  if (kernel.twice_differentiable) {
    const double a = std::sqrt(5.0) * distance / kernel.length;
    return (1 + a + a * a / 3) * std::exp(-a);
  }
  const double a = std::sqrt(3.0) * distance / kernel.length;
  return (1 + a) * std::exp(-a);
}

bool Cholesky::factor(std::vector<double> matrix, std::size_t n) {
  n_ = n;
  l_ = std::move(matrix);
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = j; i < n; ++i) {
      double sum = l_[i * n + j];
      for (std::size_t k = 0; k < j; ++k) sum -= l_[i * n + k] * l_[j * n + k];
      if (i == j) {
        if (!(sum > 0)) return false;
        l_[j * n + j] = std::sqrt(sum);
      } else {
        l_[i * n + j] = sum / l_[j * n + j];
      }
    }
  }
  return true;
}

std::vector<double> Cholesky::solve(std::vector<double> b) const {
  for (std::size_t i = 0; i < n_; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= l_[i * n_ + k] * b[k];
    b[i] /= l_[i * n_ + i];
  }
  for (std::size_t i = n_; i-- > 0;) {
    for (std::size_t k = i + 1; k < n_; ++k) b[i] -= l_[k * n_ + i] * b[k];
    b[i] /= l_[i * n_ + i];
  }
  return b;
}

std::vector<double> Cholesky::inverse() const {
  // All columns side by side: the same operations on each in the same order as solve(), but
  // independent of each other, so that the processor need not wait for one before the next.
  const std::size_t n = n_;
  std::vector<double> b(n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) b[i * n + i] = 1;
  const auto subtract = [&](std::size_t i, double factor, std::size_t k, std::size_t columns) {
    double* to = &b[i * n];
    const double* from = &b[k * n];
    for (std::size_t j = 0; j < columns; ++j) to[j] -= factor * from[j];
  };
  for (std::size_t i = 0; i < n; ++i) {
    // Column j is 0 above its row j.
    for (std::size_t k = 0; k < i; ++k) subtract(i, l_[i * n + k], k, k + 1);
    for (std::size_t j = 0; j <= i; ++j) b[i * n + j] /= l_[i * n + i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) subtract(i, l_[k * n + i], k, n);
    for (std::size_t j = 0; j < n; ++j) b[i * n + j] /= l_[i * n + i];
  }
  return b;
}

double Cholesky::log_determinant() const {
  double sum = 0;
  for (std::size_t i = 0; i < n_; ++i) sum += 2 * std::log(l_[i * n_ + i]);
  return sum;
}

double inner(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

// s^2 stands on both sides (it scales the samples' own errors): three rounds from the plain
// variance settle it.
std::optional<FactoredCovariance> factor_covariance(const SphereSamples& s,
                                                    const SphereKernel& kernel) {
  const std::size_t n = s.direction.size();
  const double mean = std::accumulate(s.value.begin(), s.value.end(), 0.0) / static_cast<double>(n);
  double variance = 0;
  for (double v : s.value) variance += (v - mean) * (v - mean) / static_cast<double>(n - 1);
  FactoredCovariance out{};
  out.noise.assign(n, 0.0);
  std::vector<double> k(n * n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      k[i * n + j] = covariance(kernel, chord(s.direction[i], s.direction[j]));
    }
  }
  for (int round = 0; round < 3; ++round) {
    for (std::size_t i = 0; i < n; ++i) {
      const double own = variance > 0 ? s.value_stderr[i] * s.value_stderr[i] / variance : 0;
      // A field that is constant within its errors is all error: the ratio is capped, not its
      // meaning.
      out.noise[i] = std::min(own, 1e6);
      k[i * n + i] = 1 + kJitter + out.noise[i];
    }
    if (!out.c.factor(k, n)) return std::nullopt;
    out.c_inv_one = out.c.solve(std::vector<double>(n, 1.0));
    out.one_c_inv_one = std::accumulate(out.c_inv_one.begin(), out.c_inv_one.end(), 0.0);
    out.trend = inner(out.c_inv_one, s.value) / out.one_c_inv_one;
    std::vector<double> residual = s.value;
    for (double& r : residual) r -= out.trend;
    variance = std::max(0.0, inner(residual, out.c.solve(residual))) / static_cast<double>(n - 1);
    out.variance = variance;
    if (variance == 0) break;
  }
  const double scale = std::max(out.variance, std::numeric_limits<double>::min());
  out.negative_log_likelihood = static_cast<double>(n - 1) * std::log(scale) +
                                out.c.log_determinant() + std::log(out.one_c_inv_one);
  return out;
}

}  // namespace irsig
