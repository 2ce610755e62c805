#include "core/gas/water_through_air.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace irsig {
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
constexpr std::size_t kShapes = LorenzCurves::kShapes, kShares = LorenzCurves::kShares;

double shape_of(std::size_t i) {
  return kShapeMin * std::pow(kShapeMax / kShapeMin, static_cast<double>(i) / (kShapes - 1));
}
// Shares dense towards 1, where the absorption is.
double fraction_of(std::size_t j) {
  const double s = 1 - static_cast<double>(j) / (kShares - 1);
  return 1 - s * s * s * s;
}

}  // namespace

const std::array<LorenzCurves::Curve, LorenzCurves::kShapes>& LorenzCurves::curves() {
  static const std::array<Curve, kShapes> table = [] {
    std::array<Curve, kShapes> out{};
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

double water_independence(double temperature_k) { return between(temperature_k, &Knot::value); }
double water_independence_spread(double temperature_k) {
  return between(temperature_k, &Knot::spread);
}
double water_thin_air_spread(double air_transmittance) {
  return 0.44 * air_transmittance * air_transmittance * air_transmittance;
}

double LorenzCurves::place_of_shape(double shape) {
  static const double per_ln = (kShapes - 1) / std::log(kShapeMax / kShapeMin);
  return std::log(std::clamp(shape, kShapeMin, kShapeMax) / kShapeMin) * per_ln;
}

LorenzCurves::Place LorenzCurves::place_of_share(double g) {
  const double y = (1 - std::sqrt(std::sqrt(std::clamp(1 - g, 0.0, 1.0)))) * (kShares - 1);
  const std::size_t j = std::min(static_cast<std::size_t>(y), kShares - 2);
  // Linear in the share itself, so that equal shares of a cell hold equal absorption.
  return {j, std::clamp((g - fraction_of(j)) / (fraction_of(j + 1) - fraction_of(j)), 0.0, 1.0)};
}

double inverse_gaussian_lorenz(double g, double shape) {
  const double x = LorenzCurves::place_of_shape(shape);
  const std::size_t i = std::min(static_cast<std::size_t>(x), kShapes - 2);
  const double u = x - static_cast<double>(i);
  const auto [j, v] = LorenzCurves::place_of_share(g);
  const auto at = [&](std::size_t a) {
    const LorenzCurves::Curve& curve = LorenzCurves::curves()[a];
    return (1 - v) * curve[j] + v * curve[j + 1];
  };
  return (1 - u) * at(i) + u * at(i + 1);
}

}  // namespace irsig
