// Rationale: sunlight scales with this table; a slip in its unit or its interpolation scales every
// reflected signature. Expected: the table's own points exactly; its trapezoidal total 1366.1 W/m2
// to the 0.1 that E490 states; 21.1 W/m2 in
//   3-5 um; within 2 % of a 5772 K blackbody of the sun's size where that is known to hold (around
//   0.9 um).
// Source: ASTM E490-00a; Planck's law with the IAU nominal solar radius.
#include "core/spectral/solar.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/constants.h"
#include "core/spectral/planck.h"
#include "tests/physics/reference_table.h"

namespace irsig {
namespace {

// Midpoint sums on a grid much finer than the table (0.5 nm at its finest, 20 nm beyond 2 um).
double integral_w_m2(double from_um, double to_um, double growth) {
  double sum = 0;
  for (double low = from_um; low < to_um;) {
    const double high = std::min(to_um, low * (1 + growth));
    sum += (high - low) * solar_irradiance_w_m2_um(0.5 * (low + high));
    low = high;
  }
  return sum;
}

TEST(Solar, TotalIsTheSolarConstant) {
  EXPECT_NEAR(integral_w_m2(0.1195, 1000, 2e-5), kSolarConstantWM2, 0.05);
  EXPECT_NEAR(integral_w_m2(3, 5, 1e-4), 21.1, 0.05);
}

TEST(Solar, TablePointsAndEnds) {
  EXPECT_EQ(solar_irradiance_w_m2_um(0.1195), 6.19e-2);
  EXPECT_EQ(solar_irradiance_w_m2_um(1000), 3.38e-9);
  EXPECT_EQ(solar_irradiance_w_m2_um(2.92), 28.9);
  EXPECT_NEAR(solar_irradiance_w_m2_um(2.93), 0.5 * (28.9 + 28.17), 1e-12);
  EXPECT_EQ(solar_irradiance_w_m2_um(0.1194), 0.0);
  EXPECT_EQ(solar_irradiance_w_m2_um(1000.1), 0.0);
  EXPECT_EQ(solar_irradiance_w_m2_um(NAN), 0.0);
}

TEST(Solar, NearAnEquivalentBlackbody) {
  const double solid_angle = std::numbers::pi * std::pow(kSolarRadiusM / kAstronomicalUnitM, 2);
  const double ratio =
      integral_w_m2(0.8, 1.0, 1e-4) / (solid_angle * planck_band_radiance_w_m2_sr(0.8, 1.0, 5772));
  EXPECT_NEAR(ratio, 1.0, 0.02);
}

// Sunlight that a coloured surface reflects lies within the stated error of the grid's sum, where
// the error for a white one would not cover it.
TEST(Solar, QuadratureOfColours) {
  int beyond_white = 0;  // cases
  struct Case {
    Band band;
    double full_um, none_um;  // reflectance 1 up to there, 0 from there
  };
  for (const Case& c :
       {Case{{"b", 0.3, 1, 0.05, {}}, 0.3, 0.42}, Case{{"b", 1, 2.5, 0.05, {}}, 1, 1.4},
        Case{{"b", 0.3, 1, 0.35, {}}, 0.5, 0.7}, Case{{"b", 3, 5, 1, {}}, 3, 3.5},
        Case{{"b", 0.4, 0.8, 0.1, {{0.45, 0}, {0.5, 1}, {0.61, 1}}}, 0.4, 0.55}}) {
    SCOPED_TRACE(c.band.lambda_min_um);
    SCOPED_TRACE(c.band.step_um);
    const double corner[] = {c.full_um, c.none_um};
    const BandGrid grid = make_band_grid(c.band, {}, corner).value();
    const SolarQuadrature stated = solar_quadrature(c.band, grid);
    const auto reflected = [&](double um) {
      return solar_irradiance_w_m2_um(um) *
             std::clamp((c.none_um - um) / (c.none_um - c.full_um), 0.0, 1.0);
    };
    double found = 0, error = 0;
    for (std::size_t k = 0; k < grid.lambda_um.size(); ++k) {
      double bin = 0;
      for (std::size_t i = grid.bin_first[k]; i < grid.bin_first[k + 1]; ++i)
        bin += grid.band_weight[i] * reflected(grid.node_um[i]);
      found += bin;
      error += stated.of_bin[k] * bin;
    }
    double exact = 0;
    constexpr int kPieces = 200000;
    const double piece_um = (c.band.lambda_max_um - c.band.lambda_min_um) / kPieces;
    for (int n = 0; n < kPieces; ++n) {
      const double um = c.band.lambda_min_um + (n + 0.5) * piece_um;
      exact += piece_um * band_response(c.band, um) * reflected(um);
    }
    EXPECT_LE(std::abs(found - exact), error);
    EXPECT_LE(error, stated.of_white * 20 * found);
    double white = 0, white_exact = 0;
    for (std::size_t i = 0; i < grid.node_um.size(); ++i)
      white += grid.band_weight[i] * solar_irradiance_w_m2_um(grid.node_um[i]);
    for (int n = 0; n < kPieces; ++n) {
      const double um = c.band.lambda_min_um + (n + 0.5) * piece_um;
      white_exact += piece_um * band_response(c.band, um) * solar_irradiance_w_m2_um(um);
    }
    if (std::abs(found / exact - 1) > std::abs(white / white_exact - 1)) ++beyond_white;
  }
  EXPECT_GE(beyond_white, 3);
}

}  // namespace
}  // namespace irsig
