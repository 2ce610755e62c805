#include "core/accuracy/replicates.h"

#include <algorithm>
#include <cmath>

namespace irsig {

void ReplicateStatistics::add(std::span<const double> values) {
  ++count_;
  const double inverse = 1.0 / count_;
  for (std::size_t i = 0; i < mean_.size(); ++i) {
    const double delta = values[i] - mean_[i];
    mean_[i] += delta * inverse;
    m2_[i] += delta * (values[i] - mean_[i]);
  }
}

Estimate ReplicateStatistics::estimate(std::size_t quantity) const {
  if (count_ < 2) return {mean_[quantity], 0};
  const double n = count_;
  return {mean_[quantity], std::sqrt(m2_[quantity] / (n * (n - 1)))};
}

double numerical_error(double stderr_of_mean, double undersampling_stderr,
                       double sum_of_bias_bounds) {
  return std::sqrt(stderr_of_mean * stderr_of_mean + undersampling_stderr * undersampling_stderr +
                   sum_of_bias_bounds * sum_of_bias_bounds / 3);
}

double stderr_wanted(double goal, double sum_of_bias_bounds) {
  const double bias = sum_of_bias_bounds / std::sqrt(3.0);
  return bias < 0.8 * goal ? std::sqrt(goal * goal - bias * bias) : 0.6 * goal;
}

double truncation_bound(const std::array<double, 3>& beyond, std::uint32_t spacing,
                        const Estimate& last, double at_most) {
  if (!(beyond[0] > 0 && beyond[1] > 0 && beyond[2] > 0)) return at_most;
  const double fall1 = std::log(beyond[0] / beyond[1]), fall2 = std::log(beyond[1] / beyond[2]);
  const bool geometric = fall2 > 0 && std::abs(fall2 - fall1) <= 0.25 * fall2 && last.value > 0 &&
                         last.stderr_ <= 0.1 * last.value;
  // r / (1 - r) with r = exp(-fall2 / spacing)
  return geometric ? std::min(at_most, 1.5 * last.value / std::expm1(fall2 / spacing)) : at_most;
}

namespace {

// m 2^j with m in 8 .. 15: a few whole nets of the sequence, at most an eighth more than n.
std::uint64_t whole_nets(double n, std::uint64_t n_max) {
  std::uint64_t unit = 1;
  while (static_cast<double>(16 * unit) < n && unit < (std::uint64_t{1} << 58)) unit *= 2;
  if (!(n <= 16 * static_cast<double>(unit))) return n_max;
  const auto multiples = static_cast<std::uint64_t>(std::ceil(n / static_cast<double>(unit)));
  return std::min(multiples * unit, n_max);
}

}  // namespace

std::uint64_t samples_needed(std::uint64_t n1, double e1, std::uint64_t n2, double e2,
                             double target, std::uint64_t n_max) {
  const double aim = 0.8 * target;
  if (e2 <= aim) return std::min(n2, n_max);
  const double slope = e1 > 0 ? std::clamp(std::log(e1 / e2) / std::log(static_cast<double>(n2) /
                                                                        static_cast<double>(n1)),
                                           0.5, 0.7)
                              : 0.5;
  return whole_nets(static_cast<double>(n2) * std::pow(e2 / aim, 1 / slope), n_max);
}

std::uint64_t samples_needed_with_unseen(std::uint64_t n1, double e1, std::uint64_t n2, double e2,
                                         double unseen, double wanted, std::uint64_t n_max) {
  if (!(unseen > 0)) return e2 > 0 ? samples_needed(n1, e1, n2, e2, wanted, n_max) : 0;
  std::uint64_t least = n_max;
  for (const double share : {0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.98}) {
    const std::uint64_t met =
        whole_nets(static_cast<double>(n2) * unseen / (share * wanted), n_max);
    const std::uint64_t sampled =
        e2 > 0 ? samples_needed(n1, e1, n2, e2, std::sqrt(1 - share * share) * wanted, n_max) : 0;
    least = std::min(least, std::max(met, sampled));
  }
  return least;
}

namespace {

// Regularised incomplete beta function by its continued fraction (modified Lentz). [dlmf, 8.17.22]
double incomplete_beta(double a, double b, double x) {
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  if (x > (a + 1) / (a + b + 2)) return 1 - incomplete_beta(b, a, 1 - x);
  const double front = std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) +
                                a * std::log(x) + b * std::log1p(-x)) /
                       a;
  double f = 1, c = 1, d = 0;
  for (int i = 0; i <= 400; ++i) {
    const int m = i / 2;
    double numerator = 1;
    if (i > 0)
      numerator = i % 2 == 0 ? m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m))
                             : -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1 / (1 + numerator * d);
    c = 1 + numerator / c;
    f *= c * d;
    if (i > 1 && std::abs(1 - c * d) < 1e-15) break;
  }
  return front * (f - 1);
}

// P(|t| > x)
double two_sided_tail(double x, double degrees) {
  return incomplete_beta(degrees / 2, 0.5, degrees / (degrees + x * x));
}

}  // namespace

double student_t_bound(std::uint32_t degrees_of_freedom, std::uint64_t rows) {
  const double tail = 2 * 0.0005 / static_cast<double>(rows);
  double low = 0, high = 1;
  while (two_sided_tail(high, degrees_of_freedom) > tail) high *= 2;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (two_sided_tail(middle, degrees_of_freedom) > tail ? low : high) = middle;
  }
  return high;
}

}  // namespace irsig
