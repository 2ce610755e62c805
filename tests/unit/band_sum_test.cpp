// Responses on stored spectra: what bins that they cut are said to be off by.
#include "view/query/band_sum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace irsig {
namespace {

constexpr double kFirstUm = 3, kStepUm = 0.05;
constexpr int kBins = 41;

double integral(const std::function<double(double)>& f, double from, double to) {
  constexpr int kPoints = 4000;
  double sum = 0;
  for (int i = 0; i < kPoints; ++i) sum += f(from + (to - from) * (i + 0.5) / kPoints);
  return sum * (to - from) / kPoints;
}

struct Off {
  double off, bound, sum;
};
// Returns the error of a spectrum under a response that is linear between its points.
Off off(const std::function<double(double)>& spectrum, const ResponseTable& response) {
  std::vector<double> lambda_um, mean;
  for (int k = 0; k < kBins; ++k) {
    lambda_um.push_back(kFirstUm + k * kStepUm);
    mean.push_back(integral(spectrum, lambda_um[k] - kStepUm / 2, lambda_um[k] + kStepUm / 2) /
                   kStepUm);
  }
  const auto weights = band_weights(lambda_um, response);
  EXPECT_TRUE(weights.ok()) << weights.status();
  double sum = 0, truth = 0;
  for (int k = 0; k < kBins; ++k) sum += weights->weight[k] * mean[k];
  for (std::size_t i = 0; i + 1 < response.size(); ++i) {
    const SpectralPoint &a = response[i], &b = response[i + 1];
    truth += integral(
        [&](double um) {
          return spectrum(um) *
                 (a.value + (b.value - a.value) * (um - a.lambda_um) / (b.lambda_um - a.lambda_um));
        },
        a.lambda_um, b.lambda_um);
  }
  return {std::abs(sum - truth), weights->shape_bound(mean), sum};
}

class BandSum : public ::testing::Test {
 protected:
  double uniform(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random_);
  }
  // Some of them to an end of the band.
  ResponseTable cut_window() {
    const double from = uniform(3.0, 4.0), to = from + uniform(0.06, 0.9);
    const double end = uniform(0, 1);
    return end < 0.2 ? window(3, to) : end < 0.4 ? window(from, 5) : window(from, to);
  }
  ResponseTable any_response() {
    ResponseTable out = {{3.07, 0}};
    while (out.back().lambda_um < 4.6)
      out.push_back({out.back().lambda_um + uniform(0.01, 0.3), uniform(0, 1)});
    return out;
  }

 private:
  std::mt19937_64 random_{7};
};

// A line narrower than a bin, anywhere; a step anywhere; both. A line on the edge of two bins tells
// least: of a hundred spectra one may be off by a little more than the bound.
TEST_F(BandSum, WhatBinsHideIsWithinTheBound) {
  int beyond = 0;
  for (int i = 0; i < 400; ++i) {
    const double line = uniform(2.98, 5.02), width = uniform(0.002, 0.02),
                 step = uniform(2.98, 5.02), height = uniform(0, 20), high = uniform(0, 5);
    const auto spectrum = [&](double um) {
      const double x = (um - line) / width;
      return 1 + height * std::exp(-x * x) + (um > step ? high : 0);
    };
    for (const ResponseTable& response : {cut_window(), any_response()}) {
      const Off found = off(spectrum, response);
      beyond += found.off > found.bound + 2e-3 ? 1 : 0;
      EXPECT_LE(found.off, 3 * found.bound + 2e-3) << line << " " << step << " " << i;
    }
  }
  EXPECT_LE(beyond, 8);
}

// The bound of a blackbody is negligible, and it covers.
TEST_F(BandSum, SmoothSpectraHaveSmallBounds) {
  for (int i = 0; i < 50; ++i) {
    const double kelvin = uniform(300, 1000);
    const auto planck = [&](double um) {
      return 1e5 / (std::pow(um, 5) * std::expm1(14387.77 / (um * kelvin)));
    };
    for (const ResponseTable& response : {cut_window(), any_response()}) {
      const Off found = off(planck, response);
      EXPECT_LE(found.off, found.bound + 1e-7 * found.sum);
      EXPECT_LE(found.bound, 2e-2 * found.sum) << kelvin;
    }
  }
}

// The first and the last bin have one neighbour.
TEST_F(BandSum, LinesInTheOutermostBinsAreCovered) {
  for (const double line : {2.983, 3.017, 4.983, 5.017}) {
    const auto spectrum = [&](double um) {
      const double x = (um - line) / 0.003;
      return 1 + 20 * std::exp(-x * x);
    };
    const Off found = off(spectrum, line < 4 ? window(3, 3.225) : window(4.775, 5));
    EXPECT_GT(found.off, 0.03) << line;
    EXPECT_LE(found.off, found.bound) << line;
  }
}

TEST_F(BandSum, WholeBinsAreExact) {
  const auto jagged = [](double um) { return 1 + std::abs(std::sin(40 * um)); };
  const Off found = off(jagged, window(3.175, 4.025));
  EXPECT_EQ(found.bound, 0);
  EXPECT_NEAR(found.off, 0, 1e-6);
}

}  // namespace
}  // namespace irsig
