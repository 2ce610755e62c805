#include "core/study/mesh_convergence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace irsig {
namespace {

double square(double x) { return x * x; }

// Sums over facets are exact to about this much.
constexpr double kRounding = 1e-12;

double weight(const MeshValue& v) {
  return 1 / square(std::max(v.error, kRounding * std::abs(v.value)));
}

// y = a + c x by weighted least squares.
struct Line {
  double at_0 = 0, at_0_error = 0, slope = 0, chi_square = 0;
};

class PowerLaw {
 public:
  PowerLaw(std::span<const double> facets, std::span<const std::vector<MeshValue>> value)
      : value_(value) {
    const double most = *std::max_element(facets.begin(), facets.end());
    for (const double n : facets) log_share_.push_back(std::log(n / most));
  }

  [[nodiscard]] Line line(std::size_t view, double order) const {
    const std::vector<MeshValue>& y = value_[view];
    double sum = 0, mean_x = 0, mean_y = 0;
    for (std::size_t i = 0; i < y.size(); ++i) {
      sum += weight(y[i]);
      mean_x += weight(y[i]) * x(i, order);
      mean_y += weight(y[i]) * y[i].value;
    }
    mean_x /= sum;
    mean_y /= sum;
    double sxx = 0, sxy = 0;
    for (std::size_t i = 0; i < y.size(); ++i) {
      sxx += weight(y[i]) * square(x(i, order) - mean_x);
      sxy += weight(y[i]) * (x(i, order) - mean_x) * (y[i].value - mean_y);
    }
    const double slope = sxy / sxx;
    Line out{mean_y - slope * mean_x, std::sqrt(1 / sum + square(mean_x) / sxx), slope, 0};
    for (std::size_t i = 0; i < y.size(); ++i)
      out.chi_square += weight(y[i]) * square(y[i].value - out.at_0 - slope * x(i, order));
    return out;
  }

  [[nodiscard]] double chi_square(double order) const {
    double out = 0;
    for (std::size_t view = 0; view < value_.size(); ++view) out += line(view, order).chi_square;
    return out;
  }

 private:
  [[nodiscard]] double x(std::size_t mesh, double order) const {
    return std::exp(-order * log_share_[mesh]);
  }
  std::span<const std::vector<MeshValue>> value_;
  std::vector<double> log_share_;  // [mesh] log(facets / most facets)
};

double order_at(int step, int steps) {
  return kLeastOrder * std::pow(kMostOrder / kLeastOrder, static_cast<double>(step) / steps);
}

}  // namespace

double MeshDeviation::significance() const {
  if (value == 0) return 0;
  return error > 0 ? std::abs(value) / error : std::numeric_limits<double>::infinity();
}

double MeshLimit::rms_off(double facets) const {
  double sum = 0;
  for (std::size_t view = 0; view < limit.size(); ++view)
    sum += square(off_at_finest[view] / limit[view].value);
  return std::sqrt(sum / static_cast<double>(limit.size())) *
         std::pow(facets / most_facets, -order);
}

MeshDeviation deviation(const MeshValue& of, const MeshValue& from) {
  if (of.value == from.value && from.value == 0) return {};
  const double ratio = of.value / from.value;
  return {ratio - 1, std::hypot(of.error, ratio * from.error) / std::abs(from.value)};
}

DeviationSummary summary_of(std::span<const MeshDeviation> deviations) {
  DeviationSummary out;
  const auto n = static_cast<double>(deviations.size());
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    const MeshDeviation& d = deviations[i];
    out.rms += square(d.value) / n;
    out.rms_error += square(d.error) / n;
    out.rms_significance += square(d.significance()) / n;
    if (std::abs(d.value) > std::abs(deviations[out.largest].value)) out.largest = i;
  }
  out.rms = std::sqrt(out.rms);
  out.rms_error = std::sqrt(out.rms_error);
  out.significant = beyond_errors(n * out.rms_significance, deviations.size());
  out.rms_significance = std::sqrt(out.rms_significance);
  return out;
}

bool beyond_errors(double chi_square, std::size_t degrees_of_freedom) {
  const auto degrees = static_cast<double>(degrees_of_freedom);
  return chi_square > degrees + 5 * std::sqrt(2 * degrees);
}

bool varies(std::span<const std::vector<MeshValue>> value) {
  double chi_square = 0;
  std::size_t degrees = 0;
  for (const std::vector<MeshValue>& y : value) {
    double sum = 0, mean = 0;
    for (const MeshValue& v : y) {
      sum += weight(v);
      mean += weight(v) * v.value;
    }
    mean /= sum;
    for (const MeshValue& v : y) chi_square += weight(v) * square(v.value - mean);
    degrees += y.size() - 1;
  }
  return beyond_errors(chi_square, degrees);
}

std::optional<MeshLimit> mesh_limit(std::span<const double> facets,
                                    std::span<const std::vector<MeshValue>> value) {
  const std::size_t meshes = facets.size(), views = value.size();
  if (std::set<double>(facets.begin(), facets.end()).size() < 3 || views == 0) return std::nullopt;
  const PowerLaw law(facets, value);

  // Chi-square has few minima over the order, and the range is short: a scan, then refined.
  constexpr int kSteps = 400;
  int best = 0;
  std::vector<double> scanned;
  for (int i = 0; i <= kSteps; ++i) {
    scanned.push_back(law.chi_square(order_at(i, kSteps)));
    if (scanned.back() < scanned[static_cast<std::size_t>(best)]) best = i;
  }
  MeshLimit out;
  out.most_facets = *std::max_element(facets.begin(), facets.end());
  double low = order_at(std::max(best - 1, 0), kSteps),
         high = order_at(std::min(best + 1, kSteps), kSteps);
  for (int i = 0; i < 100; ++i) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    if (law.chi_square(a) < law.chi_square(b))
      high = b;
    else
      low = a;
  }
  out.order = (low + high) / 2;
  out.chi_square = law.chi_square(out.order);
  out.degrees_of_freedom = views * (meshes - 2) - 1;
  // One view on three meshes leaves no degree of freedom, and still may follow no power.
  const std::size_t degrees = std::max<std::size_t>(out.degrees_of_freedom, 1);
  const double scatter = std::max(1.0, out.chi_square / static_cast<double>(degrees));

  // Outwards to where chi-square has grown: the first step beyond, then halved.
  const double allowed = out.chi_square + scatter;
  const auto edge = [&](int direction) -> std::optional<double> {
    double inside = out.order;
    for (int i = best + direction; i >= 0 && i <= kSteps; i += direction) {
      double outside = order_at(i, kSteps);
      if (scanned[static_cast<std::size_t>(i)] <= allowed) {
        inside = outside;
        continue;
      }
      for (int k = 0; k < 60; ++k) {
        const double middle = (inside + outside) / 2;
        (law.chi_square(middle) <= allowed ? inside : outside) = middle;
      }
      return inside;
    }
    return std::nullopt;
  };
  const auto least = edge(-1), most = edge(1);
  if (!least) return std::nullopt;
  out.order_low = *least;
  out.order_high = most.value_or(kMostOrder);
  out.order_high_open = !most;
  for (std::size_t view = 0; view < views; ++view) {
    const Line line = law.line(view, out.order);
    double moved = 0;
    for (const double order : {out.order_low, out.order_high})
      moved = std::max(moved, std::abs(law.line(view, order).at_0 - line.at_0));
    out.off_at_finest.push_back(line.slope);
    out.limit.push_back({line.at_0, std::hypot(std::sqrt(scatter) * line.at_0_error, moved)});
  }
  return out;
}

}  // namespace irsig
