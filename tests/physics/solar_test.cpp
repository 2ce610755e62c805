// Rationale: sunlight scales with this table; a slip in its unit or its interpolation scales every
// reflected signature. Expected: the table's own points exactly; its trapezoidal total 1366.1 W/m2
// to the 0.1 that E490 states; 21.1 W/m2 in
//   3-5 um; within 2 % of a 5772 K blackbody of the sun's size where that is known to hold (around
//   0.9 um).
// Source: ASTM E490-00a; Planck's law with the IAU nominal solar radius.
#include "core/spectral/solar.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace irsig
