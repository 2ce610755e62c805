// Rationale: stored spectra and in-band intensities are sums over this grid; its quadrature error
// enters every error
//   budget and must be bounded, not assumed.
// Expected: two Gauss points per half bin integrate cubics exactly, so the error is h^4 L''''/4320
// per panel: below 1e-8
//   for a 0.05 um grid above 3 um at 240 K; piecewise linear responses are integrated exactly
//   wherever their corners lie.
// Source: Gauss-Legendre quadrature; Planck's law (planck_test.cpp); integrals of polynomials.
#include "core/spectral/band.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "core/spectral/planck.h"

namespace irsig {
namespace {

using testing::HasSubstr;

Band mwir() { return {"MWIR", 3, 5, 0.05, {}}; }

double in_band(const BandGrid& grid, auto&& radiance) {
  double sum = 0;
  for (std::size_t i = 0; i < grid.node_um.size(); ++i) {
    sum += grid.band_weight[i] * radiance(grid.node_um[i]);
  }
  return sum;
}

TEST(BandGrid, LayoutIsAsDocumented) {
  const BandGrid grid = make_band_grid(mwir()).value();
  ASSERT_EQ(grid.lambda_um.size(), 41u);
  ASSERT_EQ(grid.node_um.size(), 164u);
  ASSERT_EQ(grid.bin_weight.size(), 164u);
  ASSERT_EQ(grid.band_weight.size(), 164u);
  EXPECT_DOUBLE_EQ(grid.step_um, 0.05);
  EXPECT_EQ(grid.lambda_um.front(), 3);
  EXPECT_EQ(grid.lambda_um.back(), 5);
  for (std::size_t i = 1; i < grid.node_um.size(); ++i) {
    EXPECT_LT(grid.node_um[i - 1], grid.node_um[i]);
  }
  for (std::size_t k = 0; k <= 40; ++k) {
    EXPECT_NEAR(grid.lambda_um[k], 3 + 0.05 * static_cast<double>(k), 1e-14);
    EXPECT_GT(grid.node_um[4 * k], grid.lambda_um[k] - 0.025);
    EXPECT_LT(grid.node_um[4 * k + 1], grid.lambda_um[k]);
    EXPECT_GT(grid.node_um[4 * k + 2], grid.lambda_um[k]);
    EXPECT_LT(grid.node_um[4 * k + 3], grid.lambda_um[k] + 0.025);
  }
  for (const std::size_t outside : {0, 1, 162, 163}) EXPECT_EQ(grid.band_weight[outside], 0.0);
  EXPECT_NEAR(std::accumulate(grid.band_weight.begin(), grid.band_weight.end(), 0.0), 2.0,
              164 * 2.3e-16);
}

TEST(BandGrid, StepIsAdjustedToDivideTheBand) {
  const BandGrid grid = make_band_grid({"b", 3, 5, 0.3, {}}).value();
  EXPECT_EQ(grid.lambda_um.size(), 8u);
  EXPECT_DOUBLE_EQ(grid.step_um, 2.0 / 7);
}

TEST(BandGrid, CubicsAreExact) {
  const BandGrid grid = make_band_grid({"b", 3, 5, 0.5, {}}).value();
  const auto cubic = [](double x) { return 2 - x + 0.5 * x * x - 0.1 * x * x * x; };
  const auto antiderivative = [](double x) {
    return 2 * x - x * x / 2 + x * x * x / 6 - 0.025 * x * x * x * x;
  };
  EXPECT_NEAR(in_band(grid, cubic), antiderivative(5) - antiderivative(3), 1e-13);
  for (std::size_t k = 0; k < grid.lambda_um.size(); ++k) {
    double mean = 0;
    for (std::size_t i = 4 * k; i < 4 * k + 4; ++i)
      mean += grid.bin_weight[i] * cubic(grid.node_um[i]);
    const double a = grid.lambda_um[k] - 0.25;
    const double b = grid.lambda_um[k] + 0.25;
    EXPECT_NEAR(mean, (antiderivative(b) - antiderivative(a)) / (b - a), 1e-13);
  }
}

TEST(BandGrid, PlanckWithinItsBound) {
  for (const Band& band : {mwir(), Band{"LWIR", 8, 12, 0.05, {}}, Band{"n", 8.5, 9, 0.05, {}},
                           Band{"coarse", 3, 5, 0.5, {}}, Band{"visible", 0.4, 0.7, 0.01, {}}}) {
    const BandGrid grid = make_band_grid(band).value();
    const double bound = quadrature_relative_bound(band, grid, 240, 800);
    for (double t = 240; t <= 800; t += 13) {
      const double exact = planck_band_radiance_w_m2_sr(band.lambda_min_um, band.lambda_max_um, t);
      const double sum = in_band(grid, [&](double x) { return planck_radiance_w_m2_sr_um(x, t); });
      EXPECT_LE(std::abs(sum / exact - 1), 1.02 * bound + 1e-13) << band.name << ", " << t << " K";
    }
    std::printf("%s: quadrature bound %.2g at %g um steps\n", band.name.c_str(), bound,
                grid.step_um);
    // The Wien side at 240 K: d ln L / d lambda = c2 / (lambda^2 T), its fourth power for L''''.
    const double slope_um = 14388 / (band.lambda_min_um * band.lambda_min_um * 240);
    EXPECT_LE(bound, 1e-12 + std::pow(grid.step_um / 2 * slope_um, 4) / 4320) << band.name;
  }
}

// Random tables of a few points, of which the grid knows the corners, over steps up to the width of
// the band.
TEST(BandGrid, SpectraOfTablesWithinTheirBound) {
  std::mt19937 random(45);
  std::uniform_real_distribution<double> between(0, 1);
  double closest = 0;
  for (int round = 0; round < 200; ++round) {
    const double low = 3 + 5 * between(random), high = low + 0.5 + 3 * between(random);
    const double step =
        (high - low) / (1 + static_cast<int>(20 * between(random) * between(random)));
    const Band band{"table", low, high, step, {}};
    std::vector<SpectralPoint> table{{low - step, between(random)}};
    for (int points = static_cast<int>(6 * between(random)); points > 0; --points)
      table.push_back({0, between(random)});
    table.push_back({high + step, between(random)});
    for (std::size_t i = 1; i + 1 < table.size(); ++i)
      table[i].lambda_um = low + (high - low) * (static_cast<double>(i) - 0.9 * between(random)) /
                                     static_cast<double>(table.size());
    std::vector<double> corners;
    for (const SpectralPoint& p : table) corners.push_back(p.lambda_um);
    const auto emissivity = [&](double x) {
      std::size_t i = 1;
      while (table[i].lambda_um < x) ++i;
      return std::lerp(
          table[i - 1].value, table[i].value,
          (x - table[i - 1].lambda_um) / (table[i].lambda_um - table[i - 1].lambda_um));
    };
    const BandGrid grid = make_band_grid(band, {}, corners).value();
    std::vector<std::vector<double>> spectra(1);
    for (const double x : grid.node_um) spectra[0].push_back(emissivity(x));
    const double coldest = 250 + 50 * between(random), hottest = coldest + 400 * between(random);
    const double bound = quadrature_relative_bound(band, grid, coldest, hottest, spectra);
    for (const double t : {coldest, 0.5 * (coldest + hottest), hottest}) {
      // The middle of many narrow strips.
      constexpr int kStrips = 20000;
      double exact = 0;
      for (int i = 0; i < kStrips; ++i) {
        const double x = low + (high - low) * (i + 0.5) / kStrips;
        exact += emissivity(x) * planck_radiance_w_m2_sr_um(x, t) * (high - low) / kStrips;
      }
      const double sum =
          in_band(grid, [&](double x) { return emissivity(x) * planck_radiance_w_m2_sr_um(x, t); });
      EXPECT_LE(std::abs(sum / exact - 1), 1.05 * bound + 1e-7)
          << "round " << round << ", " << low << " to " << high << " um, step " << step << ", " << t
          << " K";
      if (bound > 1e-5) closest = std::max(closest, std::abs(sum / exact - 1) / bound);
    }
  }
  EXPECT_GT(closest, 0.5) << "a bound that is always far too wide says nothing";
}

// A filter as it is measured: corners off the grid, a jump, limits inside the tabulated range.
Band filtered() {
  return {"filter",
          3.4,
          4.2,
          0.05,
          {{3.0, 0.2}, {3.513, 0.9}, {3.7, 0.95}, {3.904, 0.9}, {4.0671, 0.0}, {5, 0.0}}};
}

TEST(Response, ValuesBetweenPointsAndOutside) {
  const Band band = filtered();
  EXPECT_EQ(band_response(band, 3.39), 0);
  EXPECT_EQ(band_response(band, 4.21), 0);
  EXPECT_EQ(band_response(band, 3.7), 0.95);
  EXPECT_NEAR(band_response(band, 3.6065), 0.925, 1e-14);
  EXPECT_EQ(band_response(band, 4.1), 0);
  EXPECT_EQ(band_response(mwir(), 3), 1);
  EXPECT_EQ(band_response(mwir(), 5), 1);
  EXPECT_EQ(band_response(mwir(), 5.0001), 0);
  const Band narrow{"n", 3, 5, 0.1, {{3.5, 0.4}, {4.5, 0.8}}};
  EXPECT_EQ(band_response(narrow, 3.49), 0);
  EXPECT_EQ(band_response(narrow, 3.5), 0.4);
  EXPECT_EQ(band_response(narrow, 4.5), 0.8);
  EXPECT_EQ(band_response(narrow, 4.51), 0);
}

// Response x (a + b lambda) in closed form: each linear piece by Simpson's rule, exact for its
// quadratic.
TEST(Response, LinearRadianceIsIntegratedExactlyAcrossCorners) {
  const Band band = filtered();
  const auto linear = [](double x) { return 1.5 - 0.3 * x; };
  const double cuts[] = {3.4, 3.513, 3.7, 3.904, 4.0671};
  double exact = 0;
  for (int i = 0; i < 4; ++i) {
    const double a = cuts[i];
    const double b = cuts[i + 1];
    const auto f = [&](double x) { return band_response(band, x) * linear(x); };
    exact += (b - a) / 6 * (f(a) + 4 * f(0.5 * (a + b)) + f(b));
  }
  const BandGrid grid = make_band_grid(band).value();
  // The panel in which the response ends holds a weight that was moved to its nearer node: (corner
  // distance)^2.
  EXPECT_NEAR(in_band(grid, linear) / exact, 1.0, 1e-6);
  for (const double weight : grid.band_weight) EXPECT_GE(weight, 0.0);
  EXPECT_LE(quadrature_relative_bound(band, grid, 240, 800), 2e-5);
}

TEST(Response, ApparentTemperatureInvertsTheGrid) {
  for (const Band& band : {filtered(), Band{"step", 8, 12, 0.05, {{8.52, 1}, {11.48, 1}}}}) {
    const BandGrid grid = make_band_grid(band).value();
    for (const double t : {2.7, 77.0, 240.0, 306.0, 800.0, 5772.0, 1e6}) {
      const double radiance =
          in_band(grid, [&](double x) { return planck_radiance_w_m2_sr_um(x, t); });
      if (radiance < 1e-300) continue;
      EXPECT_NEAR(radiance_temperature_k(band, grid, radiance) / t, 1.0, 1e-12) << band.name;
    }
    EXPECT_EQ(radiance_temperature_k(band, grid, 0.0), 0.0);
    EXPECT_GT(radiance_temperature_k(band, grid, 5e-324), 0.0);
  }
  // A radiance that no blackbody has gives NaN, and does not end the process. Up to the highest
  // temperature the inverse works.
  for (const Band& band : {filtered(), mwir()}) {
    const BandGrid grid = make_band_grid(band).value();
    for (const double radiance : {-1.0, -5e-324, double{NAN}, double{INFINITY}, 1e200, 1e308})
      EXPECT_TRUE(std::isnan(radiance_temperature_k(band, grid, radiance))) << radiance;
    const double most = in_band(
        grid, [](double x) { return planck_radiance_w_m2_sr_um(x, kPlanckTemperatureMaxK); });
    EXPECT_NEAR(radiance_temperature_k(band, grid, 0.999 * most) / kPlanckTemperatureMaxK, 0.999,
                1e-9)
        << band.name;
    EXPECT_TRUE(std::isnan(radiance_temperature_k(band, grid, 1.001 * most))) << band.name;
  }
  // Without a response it is the closed form over the limits.
  const BandGrid grid = make_band_grid(mwir()).value();
  EXPECT_EQ(radiance_temperature_k(mwir(), grid, 2.3105), radiance_temperature_k(3, 5, 2.3105));
}

// A response of 1 everywhere inside is no response, whatever its table's points.
TEST(Response, FlatTableEqualsNone) {
  const Band flat{"flat", 3, 5, 0.05, {{2, 1}, {3.33, 1}, {6, 1}}};
  const BandGrid with = make_band_grid(flat).value();
  const BandGrid without = make_band_grid(mwir()).value();
  for (std::size_t i = 0; i < with.band_weight.size(); ++i) {
    EXPECT_NEAR(with.band_weight[i], without.band_weight[i], 1e-15);
  }
}

TEST(BandGrid, WhatIsNoBandIsRefusedWithItsReason) {
  const auto why = [](const Band& band) {
    const auto grid = make_band_grid(band);
    EXPECT_EQ(grid.status().code(), absl::StatusCode::kInvalidArgument);
    return std::string(grid.status().message());
  };
  EXPECT_THAT(why({"b", 5, 3, 0.1, {}}), HasSubstr("band \"b\": limits 5 and 3 um"));
  EXPECT_THAT(why({"b", 0, 3, 0.1, {}}), HasSubstr("limits"));
  EXPECT_THAT(why({"b", 3, NAN, 0.1, {}}), HasSubstr("limits"));
  EXPECT_THAT(why({"b", 3, 5, 0, {}}), HasSubstr("step 0 um"));
  EXPECT_THAT(why({"b", 3, 5, 2.1, {}}), HasSubstr("the width of the band"));
  EXPECT_THAT(why({"b", 3, 5, 1e-7, {}}), HasSubstr("at most"));
  EXPECT_THAT(why({"b", 0.1, 1.1, 1, {}}), HasSubstr("reach 0"));
  EXPECT_THAT(why({"b", 3, 5, 0.1, {{4, 1}}}), HasSubstr("at least two points"));
  EXPECT_THAT(why({"b", 3, 5, 0.1, {{4, 1}, {4, 0.5}}}), HasSubstr("must increase"));
  EXPECT_THAT(why({"b", 3, 5, 0.1, {{3, -0.1}, {4, 1}}}), HasSubstr("response point 1"));
  EXPECT_THAT(why({"b", 3, 5, 0.1, {{6, 1}, {7, 1}}}), HasSubstr("0 everywhere"));
  EXPECT_THAT(why({"b", 3, 5, 0.1, {{1, 1}, {3, 1}}}), HasSubstr("0 everywhere"));
}

// A table's corners are ends of panels: a notch narrower than the step is integrated as it stands.
TEST(BandGrid, CornersOfTablesAreCuts) {
  const std::vector<double> corner = {4.011, 4.013, 4.020, 4.0201};
  const std::vector<double> depth = {0, 1, 1, 0};
  const auto notch = [&](double um) {
    if (um <= corner.front() || um >= corner.back()) return 0.0;
    std::size_t k = 1;
    while (um > corner[k]) ++k;
    return std::lerp(depth[k - 1], depth[k], (um - corner[k - 1]) / (corner[k] - corner[k - 1]));
  };
  const Band band{"b", 3, 5, 0.5, {}};
  const auto in_band = [&](const BandGrid& grid) {
    double sum = 0;
    for (std::size_t i = 0; i < grid.node_um.size(); ++i)
      sum += grid.band_weight[i] * notch(grid.node_um[i]);
    return sum;
  };
  const double exact = 0.5 * (0.002 + 0.0001) + 0.007;
  EXPECT_NEAR(in_band(make_band_grid(band, {}, corner).value()), exact, 1e-15);
  EXPECT_GT(std::abs(in_band(make_band_grid(band).value()) - exact), 0.1 * exact);
}

// Wherever a response ends, what is linear is integrated as it stands: also where hardly anything
// of a panel is left.
TEST(BandGrid, ResponsesThatEndAnywhere) {
  for (const double end : {8.0004, 8.09, 8.26, 8.49, 8.5001, 8.7, 9.28, 9.499, 11.98})
    for (const double step : {1.0, 0.5, 4.0}) {
      const Band band{"b", 8, 12, step, {{7, 0.5}, {8, 0.5}, {end, 1}}};
      const BandGrid grid = make_band_grid(band).value();
      double mass = 0, moment = 0;
      for (std::size_t i = 0; i < grid.node_um.size(); ++i) {
        EXPECT_GE(grid.band_weight[i], 0);
        mass += grid.band_weight[i];
        moment += grid.band_weight[i] * (grid.node_um[i] - 8);
      }
      const double length = end - 8;
      EXPECT_NEAR(mass, 0.75 * length, 1e-12) << end << " " << step;
      EXPECT_NEAR(moment, length * length * (0.25 + 0.5 / 3), 1e-12) << end << " " << step;
    }
}

}  // namespace
}  // namespace irsig
