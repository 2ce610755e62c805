#include "core/gas/lines/lowest_eigenstates.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/check.h"

namespace irsig {
namespace {

double dot_of(const double* a, const double* b, std::size_t n) {
  double part[8] = {};
  std::size_t i = 0;
  for (; i + 8 <= n; i += 8)
    for (std::size_t j = 0; j < 8; ++j) part[j] += a[i + j] * b[i + j];
  for (; i < n; ++i) part[0] += a[i] * b[i];
  double sum = 0;
  for (const double p : part) sum += p;
  return sum;
}

// Diagonal and the elements beside it; reflections are left in the rows of a, their factors in
// `factor`.
struct Tridiagonal {
  std::vector<double> diagonal, beside, factor;  // beside[i]: between i and i + 1
};

// Row k reflects the elements from k + 1 on.
Tridiagonal reduce(std::vector<double>& a, std::size_t size) {
  Tridiagonal out{std::vector<double>(size), std::vector<double>(size), std::vector<double>(size)};
  std::vector<double> w(size);
  for (std::size_t k = 0; k < size; ++k) {
    out.diagonal[k] = a[k * size + k];
    if (k + 1 == size) break;
    double* v = &a[k * size];
    const std::size_t first = k + 1, n = size - first;
    const double norm = std::sqrt(dot_of(v + first, v + first, n));
    const double beyond = norm * norm - v[first] * v[first];
    if (k + 2 >= size || beyond <= 0) {
      out.beside[k] = v[first];
      continue;
    }
    const double head = v[first] > 0 ? -norm : norm;
    out.beside[k] = head;
    v[first] -= head;
    const double factor = 2 / dot_of(v + first, v + first, n);
    out.factor[k] = factor;
    for (std::size_t i = first; i < size; ++i)
      w[i] = factor * dot_of(&a[i * size + first], v + first, n);
    const double along = 0.5 * factor * dot_of(w.data() + first, v + first, n);
    for (std::size_t i = first; i < size; ++i) w[i] -= along * v[i];
    for (std::size_t i = first; i < size; ++i) {
      double* row = &a[i * size];
      const double vi = v[i], wi = w[i];
      for (std::size_t j = first; j < size; ++j) row[j] -= vi * w[j] + wi * v[j];
    }
  }
  return out;
}

std::vector<double> values_of(const Tridiagonal& of) {
  std::vector<double> d = of.diagonal, e = of.beside;
  const std::size_t size = d.size();
  if (size > 0) e[size - 1] = 0;
  for (std::size_t l = 0; l < size; ++l) {
    for (int turn = 0;; ++turn) {
      std::size_t m = l;
      while (m + 1 < size && std::abs(e[m]) > std::numeric_limits<double>::epsilon() *
                                                  (std::abs(d[m]) + std::abs(d[m + 1])))
        ++m;
      if (m == l) break;
      IRSIG_CHECK(turn < 60);
      double g = (d[l + 1] - d[l]) / (2 * e[l]);
      double r = std::hypot(g, 1.0);
      g = d[m] - d[l] + e[l] / (g + std::copysign(r, g));
      double s = 1, c = 1, p = 0;
      std::size_t i = m;
      bool broken = false;
      while (i-- > l) {
        const double f = s * e[i], b = c * e[i];
        r = std::hypot(f, g);
        e[i + 1] = r;
        if (r == 0) {
          d[i + 1] -= p;
          e[m] = 0;
          broken = true;
          break;
        }
        s = f / r;
        c = g / r;
        g = d[i + 1] - p;
        r = (d[i] - g) * s + 2 * c * b;
        p = s * r;
        d[i + 1] = g + p;
        g = c * r - b;
      }
      if (broken) continue;
      d[l] -= p;
      e[l] = g;
      e[m] = 0;
    }
  }
  std::ranges::sort(d);
  return d;
}

// One vector of the tridiagonal matrix by inverse iteration, orthogonal to its near neighbours.
void inverse_iteration(const Tridiagonal& of, double value, const double* near, std::size_t count,
                       double* x) {
  const std::size_t n = of.diagonal.size();
  std::vector<double> u(n), v(n), w(n), l(n);
  std::vector<bool> swapped(n);
  const double tiny = 1e-13 * (std::abs(value) + 1);
  double d = of.diagonal[0] - value, s = n > 1 ? of.beside[0] : 0;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double below = of.beside[i], d2 = of.diagonal[i + 1] - value,
                 s2 = i + 2 < n ? of.beside[i + 1] : 0;
    swapped[i] = std::abs(below) > std::abs(d);
    if (swapped[i]) {
      u[i] = below, v[i] = d2, w[i] = s2;
      l[i] = d / below;
      d = s - l[i] * d2;
      s = -l[i] * s2;
    } else {
      if (std::abs(d) < tiny) d = tiny;
      u[i] = d, v[i] = s, w[i] = 0;
      l[i] = below / d;
      d = d2 - l[i] * s;
      s = s2;
    }
  }
  u[n - 1] = std::abs(d) < tiny ? tiny : d;
  for (std::size_t i = 0; i < n; ++i)  // no symmetry that a vector could lack
    x[i] = 1 + 0.5 * std::sin(1.7 * static_cast<double>(i) + 0.3);
  for (int turn = 0; turn < 4; ++turn) {
    if (turn > 0)
      for (std::size_t i = 0; i + 1 < n; ++i) {
        if (swapped[i]) std::swap(x[i], x[i + 1]);
        x[i + 1] -= l[i] * x[i];
      }
    for (std::size_t i = n; i-- > 0;) {
      double sum = x[i];
      if (i + 1 < n) sum -= v[i] * x[i + 1];
      if (i + 2 < n) sum -= w[i] * x[i + 2];
      x[i] = sum / u[i];
    }
    double most = 0;
    for (std::size_t i = 0; i < n; ++i) most = std::max(most, std::abs(x[i]));
    for (std::size_t i = 0; i < n; ++i) x[i] /= most;
    for (std::size_t k = 0; k < count; ++k) {
      const double along = dot_of(near + k * n, x, n);
      for (std::size_t i = 0; i < n; ++i) x[i] -= along * near[k * n + i];
    }
    const double norm = std::sqrt(dot_of(x, x, n));
    for (std::size_t i = 0; i < n; ++i) x[i] /= norm;
  }
}

}  // namespace

LowestEigenstates lowest_eigenstates(std::vector<double>& a, std::size_t size, double at_most) {
  IRSIG_CHECK(a.size() == size * size);
  LowestEigenstates out;
  if (size == 0) return out;
  const Tridiagonal reduced = reduce(a, size);
  out.value = values_of(reduced);
  out.value.erase(std::ranges::upper_bound(out.value, at_most), out.value.end());
  const std::size_t count = out.value.size();
  out.vector.assign(count * size, 0.0);
  const double scale = std::abs(reduced.diagonal.front()) + std::abs(reduced.diagonal.back()) + 1;
  std::size_t first = 0;
  for (std::size_t n = 0; n < count; ++n) {
    while (out.value[n] - out.value[first] > 1e-5 * scale) ++first;
    inverse_iteration(reduced, out.value[n], &out.vector[first * size], n - first,
                      &out.vector[n * size]);
  }
  for (std::size_t k = size; k-- > 0;) {
    if (reduced.factor[k] == 0) continue;
    const double* v = &a[k * size];
    const std::size_t begin = k + 1;
    for (std::size_t n = 0; n < count; ++n) {
      double* x = &out.vector[n * size];
      const double along = reduced.factor[k] * dot_of(v + begin, x + begin, size - begin);
      for (std::size_t i = begin; i < size; ++i) x[i] -= along * v[i];
    }
  }
  return out;
}

}  // namespace irsig
