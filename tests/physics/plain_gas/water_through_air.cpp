#include "tests/physics/plain_gas/water_through_air.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace irsig::plain {
namespace {

struct Knot {
  double temperature_k, value, spread;
};
constexpr std::array<Knot, 6> kIndependence = {
    {{300, 0, 0.01},
     {500, 0.065, 0.025},
     {700, 0.185, 0.045},
     {1000, 0.38, 0.055},
     {1500, 0.57, 0.06},
     {2000, 0.75, 0.10}}};  // the last: continued, not measured

double between(double temperature_k, double Knot::*what) {
  const double t = std::clamp(temperature_k, kIndependence.front().temperature_k,
                              kIndependence.back().temperature_k);
  std::size_t i = 0;
  while (i + 2 < kIndependence.size() && t > kIndependence[i + 1].temperature_k) ++i;
  const Knot &a = kIndependence[i], &b = kIndependence[i + 1];
  return a.*what +
         (b.*what - a.*what) * (t - a.temperature_k) / (b.temperature_k - a.temperature_k);
}

// Inverse Gaussian of mean 1: cumulative share of wavenumbers and of absorption below x.
struct Below {
  double share, absorption;
};
Below below(double x, double shape) {
  const double root = std::sqrt(shape / x);
  const auto normal = [](double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); };
  const double first = normal(root * (x - 1)),
               second = std::exp(2 * shape) * normal(-root * (x + 1));
  return {std::min(1.0, first + second), std::max(0.0, first - second)};
}

constexpr double kShapeMin = 1e-4, kShapeMax = 50;
constexpr std::size_t kShapes = 72, kShares = 161;

double shape_of(std::size_t i) {
  return kShapeMin * std::pow(kShapeMax / kShapeMin, static_cast<double>(i) / (kShapes - 1));
}
// Shares dense towards 1, where the absorption is.
double fraction_of(std::size_t j) {
  const double s = 1 - static_cast<double>(j) / (kShares - 1);
  return 1 - s * s * s * s;
}

using Curves = std::array<std::array<double, kShares>, kShapes>;

const Curves& curves() {
  static const Curves table = [] {
    Curves out{};
    for (std::size_t i = 0; i < kShapes; ++i) {
      const double shape = shape_of(i);
      for (std::size_t j = 1; j + 1 < kShares; ++j) {
        double low = std::log(1e-8), high = std::log(1e12);
        for (int n = 0; n < 70; ++n) {
          const double middle = 0.5 * (low + high);
          (below(std::exp(middle), shape).share < fraction_of(j) ? low : high) = middle;
        }
        out[i][j] = below(std::exp(low), shape).absorption;
      }
      out[i][kShares - 1] = 1;
    }
    return out;
  }();
  return table;
}

}  // namespace

double water_independence(double temperature_k) { return between(temperature_k, &Knot::value); }
double water_independence_spread(double temperature_k, double air_transmittance) {
  return std::hypot(between(temperature_k, &Knot::spread),
                    0.44 * air_transmittance * air_transmittance * air_transmittance);
}

double inverse_gaussian_lorenz(double g, double shape) {
  const double x = std::log(std::clamp(shape, kShapeMin, kShapeMax) / kShapeMin) /
                   std::log(kShapeMax / kShapeMin) * (kShapes - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(x), kShapes - 2);
  const double y = (1 - std::pow(std::clamp(1 - g, 0.0, 1.0), 0.25)) * (kShares - 1);
  const std::size_t j = std::min(static_cast<std::size_t>(y), kShares - 2);
  const double u = x - static_cast<double>(i);
  // Linear in the share itself, so that equal shares of a cell hold equal absorption.
  const double v =
      std::clamp((g - fraction_of(j)) / (fraction_of(j + 1) - fraction_of(j)), 0.0, 1.0);
  const auto at = [&](std::size_t a) { return (1 - v) * curves()[a][j] + v * curves()[a][j + 1]; };
  return (1 - u) * at(i) + u * at(i + 1);
}

WaterThroughAir::WaterThroughAir(const GasTerms& cold) : product_(0) {
  std::vector<std::size_t> order(cold.depth.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return cold.depth[i]; });
  double sum = 0;
  for (const std::size_t i : order) {
    // Four bins of each term, as the hot gas's absorption varies within it.
    for (const double share : {0.4, 0.3, 0.2, 0.1}) {
      const double w = cold.weight[i] * share;
      point_.push_back({w, sum, sum + w, std::exp(-cold.depth[i])});
      product_ += w * point_.back().air;
      sum += w;
    }
  }
  if (point_.empty()) {  // no lines of cold water here
    point_.push_back({1, 0, 1, 1});
    product_ = 1;
  }
}

WaterThroughAir::Share WaterThroughAir::add(double weak_depth, double lorentz) {
  double through = 0, all = 0, last = 0;
  for (Point& p : point_) {
    const double next = inverse_gaussian_lorenz(p.end, 2 * lorentz);
    const double depth = weak_depth * (next - last) / p.weight;
    const double taken = p.weight * std::exp(-p.depth) * -std::expm1(-depth);
    through += taken * p.air;
    all += taken;
    p.depth += depth;
    last = next;
  }
  return {all > 0 ? through / all : point_.front().air, product_};
}

}  // namespace irsig::plain
