#include "core/hot_gas/gas_on_view.h"

#include <cmath>

#include "core/base/ordered_dot.h"
#include "core/plume/march.h"

namespace irsig {
namespace {

// Ridge of the fit, relative to the mean square of the classes' products with each other. It keeps
// shares of columns that are nearly sums of one another from growing with opposite signs. A sphere
// before a wall of its temperature leaves 0.5 % at 3-5 um with 1e-4 to 1e-10, and at 8-12 um 0.1 %
// with 1e-4, 0.06 % with less; shares that must not be negative leave 1.5 % there.
constexpr double kRidge = 1e-5;

}  // namespace

SegmentSteps view_steps() {
  SegmentSteps steps;
  steps.temperature_step = 0.06;
  return steps;
}

std::optional<double> ColumnCollector::cross(Vec<Body> from, Vec<Body> direction, double end_m,
                                             std::span<double> /*measure*/,
                                             std::span<float> /*share*/) const {
  GasColumn column = march(*field_, {centre_ + from, direction, 0, end_m}, steps_);
  if (!column.empty()) columns_.push_back(std::move(column));
  return std::nullopt;
}

GasOnView::GasOnView(std::shared_ptr<const PlumeField> field, Vec<Body> centre,
                     const ColumnTests& tests, const Absorbed& most,
                     const std::vector<std::vector<double>>& classes, ThickGas thick)
    : field_(std::move(field)),
      centre_(centre),
      steps_(view_steps()),
      tests_(tests),
      thick_(std::move(thick)) {
  for (std::size_t g = 0; g < scale_.size(); ++g) scale_[g] = most[g] > 0 ? 1 / most[g] : 0;
  for (const std::vector<double>& one : classes) {
    Absorbed& absorbed = classes_.emplace_back(ColumnTests::absorbed(one));
    for (std::size_t g = 0; g < scale_.size(); ++g) absorbed[g] *= scale_[g];
  }
  // The inverse of products + ridge by Gauss and Jordan: symmetric and positive, no pivots needed.
  const std::size_t n = classes_.size();
  std::vector<std::vector<double>> m(n, std::vector<double>(2 * n, 0.0));
  double trace = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j)
      m[i][j] = ordered_dot(classes_[i].data(), classes_[j].data(), ColumnTests::kGases);
    trace += m[i][i];
    m[i][n + i] = 1;
  }
  for (std::size_t i = 0; i < n; ++i) m[i][i] += kRidge * trace / static_cast<double>(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double pivot = m[i][i];
    for (double& x : m[i]) x /= pivot;
    for (std::size_t r = 0; r < n; ++r) {
      if (r == i) continue;
      const double factor = m[r][i];
      for (std::size_t c = 0; c < 2 * n; ++c) m[r][c] -= factor * m[i][c];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    auto& to = fraction_of_.emplace_back();
    to.fill(0);
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t g = 0; g < to.size(); ++g) to[g] += m[i][n + j] * classes_[j][g];
  }
}

GasOnView::Shares GasOnView::shares(std::span<const double> tests) const {
  auto own = ColumnTests::absorbed(tests);
  for (std::size_t g = 0; g < own.size(); ++g) own[g] *= scale_[g];
  Shares out;
  for (std::size_t k = 0; k < classes_.size(); ++k)
    out.of_class[k] = ordered_dot(fraction_of_[k].data(), own.data(), own.size());
  double off = 0;
  for (std::size_t g = 0; g < own.size(); ++g) {
    double left = own[g];
    for (std::size_t k = 0; k < classes_.size(); ++k) left -= out.of_class[k] * classes_[k][g];
    off += left * left;
  }
  out.unlike = std::sqrt(off / static_cast<double>(own.size()));
  return out;
}

std::optional<double> GasOnView::cross(Vec<Body> from, Vec<Body> direction, double end_m,
                                       std::span<double> measure, std::span<float> share) const {
  const GasColumn column = march(*field_, {centre_ + from, direction, 0, end_m}, steps_);
  if (column.empty()) return std::nullopt;
  tests_.test(column, measure.first(ColumnTests::kCount));
  const double thick = -std::expm1(-thick_.optical_depth);
  const auto absorbed = ColumnTests::absorbed(measure);
  for (std::size_t b = 0; b < thick_.weight.size(); ++b)
    measure[ColumnTests::kCount + b] =
        ordered_dot(absorbed.data(), thick_.weight[b].data(), absorbed.size()) >= thick ? 1 : 0;
  const Shares shares = this->shares(measure);
  for (std::size_t k = 0; k < share.size(); ++k) share[k] = static_cast<float>(shares.of_class[k]);
  return 0.5 * (column.front().start_m + column.back().end_m);
}

}  // namespace irsig
