// Rationale: the structure of a rough sea follows from the spectrum of its slopes.
// Expected: Cox and Munk's slopes and Pierson and Moskowitz' wave height; averages over rectangles
// by random pairs of places; the kernel of one slope by its series.
// Source: [cox1954], [pierson1964], [mehler1866] and arithmetic in this file.

#include "core/environment/sea/sea_texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/environment/sea/sea_surface.h"

namespace irsig {
namespace {

// Integral of k^power S(k).
double moment(int power, double wind_m_s) {
  double sum = 0;
  constexpr double kStep = 1e-3;
  for (double u = std::log(1e-4); u < std::log(1e4); u += kStep) {
    const double k = std::exp(u + 0.5 * kStep);
    sum += kStep * std::pow(k, power + 1) * wave_spectrum_m3(k, wind_m_s);
  }
  return sum;
}

TEST(SeaTexture, WavesHaveMeasuredSlopesAndHeights) {
  for (const double wind : {5.0, 8.0, 10.0, 14.0})
    EXPECT_NEAR(moment(2, wind) / sea_slope_variance(wind), 1, 0.2) << wind;
  // Wind at 10 m is 0.93 of that at 19.5 m.
  for (const double wind : {7.0, 10.0, 15.0})
    EXPECT_NEAR(4 * std::sqrt(moment(0, wind)) / (0.0213 * std::pow(wind / 0.93, 2)), 1, 0.15)
        << wind;
}

TEST(SeaTexture, NodesIntegratePolynomialsExactly) {
  double expected = 1;
  for (int power = 0; power <= 22; power += 2) {
    double sum = 0;
    for (const SlopeNode& n : slope_nodes()) sum += n.weight * std::pow(n.x, power);
    EXPECT_NEAR(sum / expected, 1, 1e-11) << power;
    expected *= power + 1;
  }
  EXPECT_EQ(slope_nodes().size(), 12u);
  EXPECT_NEAR(hermite_functions(1.7)[3], (std::pow(1.7, 3) - 3 * 1.7) / std::sqrt(6.0), 1e-14);
}

// Correlations as means over 2000 waves of random directions.
TEST(SeaTexture, SlopesAreCorrelatedAsRandomWavesAre) {
  constexpr double kWind = 8;
  const SlopeCorrelation sea(kWind);
  const double all = moment(2, kWind);
  for (const auto& [x, y] : {std::pair{0.05, 0.0}, {0.0, 0.4}, {1.5, 1.5}, {6.0, -2.0}}) {
    double along = 0, across = 0;
    constexpr double kStep = 2e-3;
    for (double u = std::log(1e-3); u < std::log(5e3); u += kStep) {
      const double k = std::exp(u), power = kStep * k * k * k * wave_spectrum_m3(k, kWind);
      constexpr int kTurns = 720;
      for (int i = 0; i < kTurns; ++i) {
        const double turn = 2 * M_PI * (i + 0.5) / kTurns;
        const double wave =
            power / kTurns * std::cos(k * (x * std::cos(turn) + y * std::sin(turn)));
        along += 2 * wave * std::pow(std::cos(turn), 2);
        across += 2 * wave * std::pow(std::sin(turn), 2);
      }
    }
    EXPECT_NEAR(sea.at(x, y).x, along / all, 0.01) << x << " " << y;
    EXPECT_NEAR(sea.at(x, y).y, across / all, 0.01) << x << " " << y;
  }
  EXPECT_EQ(sea.at(0, 0).x, 1);
}

// Mean over pairs of random places in a rectangle. Half of them are close together: x = side u^3.
template <typename Function>
double over_pairs(double side_x_m, double side_y_m, const Function& of) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform;
  double sum = 0;
  constexpr int kPairs = 100000;
  for (int i = 0; i < kPairs; ++i) {
    const auto lag = [&](double side, double& weight) {
      const double u = uniform(random), x = u * u * u;
      weight *= 2 * (1 - x) * 3 * u * u;
      return side * x;
    };
    double weight = 1;
    const double x = lag(side_x_m, weight), y = lag(side_y_m, weight);
    sum += weight * of(x, y) / kPairs;
  }
  return sum;
}

TEST(SeaTexture, AveragesEqualThoseOverRandomPairs) {
  const SlopeCorrelation sea(6);
  for (const auto& [x, y] : {std::pair{0.5, 0.5}, {40.0, 10.0}, {900.0, 30.0}}) {
    const SlopeAverages averages(sea, x, y);
    for (std::size_t t = 2; t < slope_terms().size(); ++t) {
      const SlopeTerm of = slope_terms()[t];
      if ((of.a + of.b) % 2 != 0) continue;
      const double expected = over_pairs(x, y, [&](double dx, double dy) {
        return std::pow(sea.at(dx, dy).x, of.a) * std::pow(sea.at(dx, dy).y, of.b);
      });
      EXPECT_NEAR(averages.term()[t], expected, 0.04 * expected + 1e-7)
          << x << " " << y << ", " << of.a << " " << of.b;
    }
  }
  // Nothing is averaged over a place, and less is left of a larger one.
  EXPECT_GT(SlopeAverages(sea, 0.01, 0.01).term()[0], 0.8);
  EXPECT_LT(SlopeAverages(sea, 100, 100).term()[0],
            0.02 * SlopeAverages(sea, 10, 10).term()[0] * 5);
}

// For a small rectangle the sums over waves equal those over pairs.
TEST(SeaTexture, LinearTermsEqualThoseOverRandomPairs) {
  const SlopeCorrelation sea(6);
  const SlopeCorrelation::Pair mean = sea.variance_of_mean(2, 1);
  EXPECT_EQ(SlopeAverages(sea, 2, 1).term()[0], mean.x);
  EXPECT_EQ(SlopeAverages(sea, 2, 1).term()[1], mean.y);
  EXPECT_GT(std::abs(mean.x / mean.y - 1), 0.1);
  EXPECT_NEAR(mean.x / over_pairs(2, 1, [&](double x, double y) { return sea.at(x, y).x; }), 1,
              0.02);
  EXPECT_NEAR(mean.y / over_pairs(2, 1, [&](double x, double y) { return sea.at(x, y).y; }), 1,
              0.02);
}

TEST(SeaTexture, LightOfOneSlopeIsTheSumOfItsSeries) {
  const SlopeCorrelation sea(6);
  constexpr double kX = 1.2, kY = -0.7, kBlur = 0.02;
  const SlopeAverages averages(sea, 20, 20);
  const double expected = over_pairs(20, 20, [&](double dx, double dy) {
    const auto series = [](double r, double x) {
      double last = 0, now = 1, sum = 1, power = 1;
      for (int n = 0; n < 200; ++n) {
        const double next =
            (x * now - std::sqrt(static_cast<double>(n)) * last) / std::sqrt(n + 1.0);
        last = now;
        now = next;
        power *= r / (1 + kBlur);
        sum += power * now * now;
      }
      return sum;
    };
    const SlopeCorrelation::Pair r = sea.at(dx, dy);
    return series(r.x, kX) * series(r.y, kY) - 1;
  });
  EXPECT_NEAR(averages.of_one_slope(kX, kY, kBlur) / expected, 1, 0.05);
}

}  // namespace
}  // namespace irsig
