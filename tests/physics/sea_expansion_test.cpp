// Rationale: means of a rough sea over a square of a picture vary as its waves have it.
// Expected: the scatter over seas that are sums of random waves, seen at two elevations, of light
// that depends on the slopes smoothly and of light from a patch of slopes.
// Source: arithmetic in this file.

#include "core/signature/sea_expansion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "core/environment/sea/sea_surface.h"

namespace irsig {
namespace {

constexpr double kWind = 6;

struct Scatter {
  double mean, sigma;
};

// Means of `radiance`, of slopes in standard deviations, weighted with projected area.
Scatter over_random_seas(const SeaSight& sight, double side_m,
                         const std::function<double(double, double)>& radiance) {
  constexpr int kWaves = 400, kPlaces = 300, kSeas = 400;
  std::vector<double> k_of, sum_of;
  double all = 0;
  for (double u = std::log(0.02); u < std::log(5e3); u += 0.01) {
    const double k = std::exp(u);
    k_of.push_back(k);
    sum_of.push_back(all += k * k * k * wave_spectrum_m3(k, kWind));
  }
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform;
  double first = 0, second = 0;
  for (int sea = 0; sea < kSeas; ++sea) {
    struct Wave {
      double x, y, phase;  // x, y: along unit vectors, then wave numbers
      double along, across;
    };
    std::vector<Wave> wave;
    for (int i = 0; i < kWaves; ++i) {
      const auto at = std::lower_bound(sum_of.begin(), sum_of.end(), uniform(random) * all);
      const double k = k_of[static_cast<std::size_t>(at - sum_of.begin())];
      const double turn = 2 * M_PI * uniform(random);
      wave.push_back({k * std::cos(turn), k * std::sin(turn), 2 * M_PI * uniform(random),
                      std::cos(turn), std::sin(turn)});
    }
    double light = 0, area = 0;
    for (int place = 0; place < kPlaces; ++place) {
      const double x = uniform(random) * side_m / sight.sine, y = uniform(random) * side_m;
      double slope_x = 0, slope_y = 0;
      for (const Wave& w : wave) {
        const double swing = std::cos(w.x * x + w.y * y + w.phase) * 2 / std::sqrt(kWaves);
        slope_x += w.along * swing;
        slope_y += w.across * swing;
      }
      const double seen = std::max(0.0, dot(sight.steep_normal(slope_x, slope_y), sight.to_sensor));
      area += seen;
      light += seen * radiance(slope_x, slope_y);
    }
    const double mean = light / area;
    first += mean / kSeas;
    second += mean * mean / kSeas;
  }
  return {first, std::sqrt(second - first * first)};
}

Scatter expected(const SeaSight& sight, double side_m, const SlopeExpansion& of) {
  const std::vector<double> variance =
      of.variances(sight.averages(SlopeCorrelation(kWind), side_m));
  const auto source = of.sources();
  double sum = 0;
  for (std::size_t s = 0; s < source.size(); ++s) sum += variance[s] * source[s][0] * source[s][0];
  return {of.mean()[0], std::sqrt(sum)};
}

SeaSight sight_at(double elevation_deg) {
  const double e = elevation_deg * M_PI / 180;
  return {{-std::cos(e) * 0.6, std::cos(e) * 0.8, -std::sin(e)}, kWind};
}

// 400 seas tell a standard deviation to 4 %; 300 places of each add a few percent of their own.
TEST(SeaExpansion, SmoothLightVariesAsOverRandomSeas) {
  for (const double elevation_deg : {20.0, 70.0}) {
    const SeaSight sight = sight_at(elevation_deg);
    const auto radiance = [](double x, double y) { return 3 + 0.5 * x - 0.3 * y + 0.4 * x * x; };
    const SlopeExpansion of(
        sight,
        [&](Vec<Body> normal) {
          const double up = -normal.z * sight.deviation;
          return std::vector{radiance(-dot(normal, sight.x) / up, -dot(normal, sight.y) / up)};
        },
        std::nullopt);
    const Scatter stated = expected(sight, 3, of), found = over_random_seas(sight, 3, radiance);
    EXPECT_NEAR(stated.mean, found.mean, 0.05) << elevation_deg;
    EXPECT_NEAR(found.sigma / stated.sigma, 1, 0.13) << elevation_deg;
  }
}

// A patch of slopes in place of the sun's disk.
TEST(SeaExpansion, LightOfOneSlopeVariesAsOverRandomSeas) {
  const SeaSight sight = sight_at(50);
  constexpr double kX = 1.0, kY = -0.5, kWidth2 = 0.1;
  const auto radiance = [](double x, double y) {
    return std::exp(-0.5 * (std::pow(x - kX, 2) + std::pow(y - kY, 2)) / kWidth2);
  };
  const Scatter found = over_random_seas(sight, 0.5, radiance);
  // The mean of a Gaussian patch over Gaussian slopes is largest where both overlap.
  const double narrow = 1 / (1 + kWidth2), root = std::sqrt(narrow);
  SlopeExpansion::Glint glint{{found.mean}, kX * root, kY * root, kWidth2};
  const SlopeExpansion of(
      sight, [](Vec<Body>) { return std::vector{0.0}; }, glint);
  EXPECT_NEAR(found.sigma / expected(sight, 0.5, of).sigma, 1, 0.15);
}

// The sun's disk is far narrower than the terms resolve.
TEST(SeaExpansion, TheLastSourceHasWhatNoTermHoldsOfTheSun) {
  const SeaSight sight = sight_at(50);
  constexpr double kX = 1.0, kY = -0.5, kDisk = 1e-4;
  const SlopeAverages averages = sight.averages(SlopeCorrelation(kWind), 0.5);
  const SlopeExpansion of(
      sight, [](Vec<Body>) { return std::vector{0.0}; },
      SlopeExpansion::Glint{{1.0}, kX, kY, kDisk});
  const std::vector<double> variance = of.variances(averages), x = hermite_functions(kX),
                            y = hermite_functions(kY);
  double sum = variance.back();
  for (std::size_t t = 0; t + 1 < variance.size(); ++t)
    sum += variance[t] * std::pow(x[static_cast<std::size_t>(slope_terms()[t].a)] *
                                      y[static_cast<std::size_t>(slope_terms()[t].b)],
                                  2);
  EXPECT_NEAR(sum / averages.of_one_slope(kX, kY, kDisk), 1, 1e-12);
  EXPECT_GT(variance.back(), 0.005 * sum);
}

}  // namespace
}  // namespace irsig
