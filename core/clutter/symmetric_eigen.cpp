#include "core/clutter/symmetric_eigen.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace irsig {

SymmetricEigen symmetric_eigen(std::vector<std::vector<double>> m, double negligible) {
  const std::size_t n = m.size();
  // [vector][component]: the transpose of the product of rotations.
  std::vector<std::vector<double>> turned(n, std::vector<double>(n, 0.0));
  double trace = 0;
  for (std::size_t i = 0; i < n; ++i) {
    turned[i][i] = 1;
    trace += m[i][i];
  }
  const double least = negligible * trace;
  bool moved = trace > 0;
  // Convergence is quadratic: 10 sweeps are many.
  for (int sweep = 0; moved && sweep < 60; ++sweep) {
    moved = false;
    for (std::size_t p = 0; p + 1 < n; ++p)
      for (std::size_t q = p + 1; q < n; ++q) {
        const double off = m[p][q];
        if (!(std::abs(off) > least)) continue;
        moved = true;
        const double theta = (m[q][q] - m[p][p]) / (2 * off);
        const double t = std::copysign(1 / (std::abs(theta) + std::hypot(theta, 1.0)), theta);
        const double c = 1 / std::hypot(t, 1.0), s = t * c;
        // Rows, then columns, of which both are kept.
        for (std::size_t k = 0; k < n; ++k) {
          if (k == p || k == q) continue;
          const double kp = m[p][k], kq = m[q][k];
          m[p][k] = m[k][p] = c * kp - s * kq;
          m[q][k] = m[k][q] = s * kp + c * kq;
        }
        m[p][p] -= t * off;
        m[q][q] += t * off;
        m[p][q] = m[q][p] = 0;
        for (std::size_t k = 0; k < n; ++k) {
          const double vp = turned[p][k], vq = turned[q][k];
          turned[p][k] = c * vp - s * vq;
          turned[q][k] = s * vp + c * vq;
        }
      }
  }
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return m[a][a] > m[b][b]; });
  SymmetricEigen out;
  for (const std::size_t i : order) {
    out.value.push_back(std::max(0.0, m[i][i]));
    std::vector<double>& vector = out.vector.emplace_back(std::move(turned[i]));
    const double largest = *std::max_element(
        vector.begin(), vector.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    if (largest < 0)
      for (double& v : vector) v = -v;
  }
  return out;
}

}  // namespace irsig
