#include "core/environment/sea/sea_texture.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace irsig {
namespace {

constexpr int kSlopeNodes = 12;

std::vector<double> hermite_up_to(int most, double x) {
  std::vector<double> he{1.0, x};
  for (int n = 1; n < most; ++n)
    he.push_back((x * he[static_cast<std::size_t>(n)] -
                  std::sqrt(static_cast<double>(n)) * he[static_cast<std::size_t>(n - 1)]) /
                 std::sqrt(n + 1.0));
  return he;
}

// Zeros of he_n by bisection, and Gaussian quadrature's weights 1 / (n he_(n-1)^2).
std::vector<SlopeNode> gaussian_nodes() {
  const auto value = [](double x) { return hermite_up_to(kSlopeNodes, x).back(); };
  std::vector<SlopeNode> out;
  constexpr double kStep = 0.05;
  for (double low = -6.525; low < 6.5; low += kStep) {
    double a = low, b = low + kStep;
    if (value(a) * value(b) > 0) continue;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (a + b);
      (value(a) * value(middle) <= 0 ? b : a) = middle;
    }
    const double before = hermite_up_to(kSlopeNodes - 1, a).back();
    out.push_back({a, 1 / (kSlopeNodes * before * before)});
  }
  return out;
}

struct Cell {
  double lag_m, weight;
};

// Lags along one side and their shares of all pairs of places, in cells of nearly equal ratios.
std::vector<Cell> lags_along(double side_m) {
  constexpr double kFirstM = 3e-4;
  const auto cells = static_cast<int>(std::ceil(16 * std::log10(side_m / kFirstM)));
  std::vector<Cell> out;
  double from = 0;
  for (int i = 0; i <= cells; ++i) {
    const double to =
        std::min(side_m, kFirstM * std::pow(side_m / kFirstM, static_cast<double>(i) / cells));
    const double middle = 0.5 * (from + to);
    out.push_back({middle, 2 * (to - from) / side_m * (1 - middle / side_m)});
    from = to;
  }
  return out;
}

}  // namespace

const std::vector<SlopeTerm>& slope_terms() {
  static const std::vector<SlopeTerm> terms = [] {
    std::vector<SlopeTerm> out;
    for (int n = 1; n <= kSlopeOrder; ++n)
      for (int b = 0; b <= n; ++b) out.push_back({n - b, b});
    return out;
  }();
  return terms;
}

std::vector<double> hermite_functions(double x) { return hermite_up_to(kSlopeOrder, x); }

const std::vector<SlopeNode>& slope_nodes() {
  static const std::vector<SlopeNode> nodes = gaussian_nodes();
  return nodes;
}

SlopeAverages::SlopeAverages(const SlopeCorrelation& sea, double side_x_m, double side_y_m) {
  const std::vector<Cell> along = lags_along(side_x_m), across = lags_along(side_y_m);
  term_.assign(slope_terms().size(), 0.0);
  for (const Cell& x : along)
    for (const Cell& y : across) {
      const Lag& lag = lag_.emplace_back(Lag{x.weight * y.weight, sea.at(x.lag_m, y.lag_m)});
      std::array<double, kSlopeOrder + 1> of_x{1.0}, of_y{1.0};
      for (std::size_t n = 1; n < of_x.size(); ++n) {
        of_x[n] = of_x[n - 1] * lag.correlation.x;
        of_y[n] = of_y[n - 1] * lag.correlation.y;
      }
      for (std::size_t t = 0; t < term_.size(); ++t) {
        const SlopeTerm& of = slope_terms()[t];
        term_[t] += lag.weight * of_x[static_cast<std::size_t>(of.a)] *
                    of_y[static_cast<std::size_t>(of.b)];
      }
    }
  // Terms that are linear in a slope nearly cancel over a large rectangle: sums over waves give the
  // rest.
  const SlopeCorrelation::Pair linear = sea.variance_of_mean(side_x_m, side_y_m);
  term_[0] = linear.x;
  term_[1] = linear.y;
  for (double& t : term_) t = std::max(0.0, t);
}

double SlopeAverages::of_one_slope(double x, double y, double blur) const {
  // Mehler's kernel at equal slopes; blur damps the n-th term by (1 + blur)^n.
  const auto kernel = [blur](double r, double at) {
    const double c = std::clamp(r, -0.99, 1.0) / (1 + blur);
    return std::exp(c * at * at / (1 + c)) / std::sqrt(1 - c * c);
  };
  double sum = 0;
  for (const Lag& lag : lag_)
    sum += lag.weight * (kernel(lag.correlation.x, x) * kernel(lag.correlation.y, y) - 1);
  return std::max(0.0, sum);
}

}  // namespace irsig
