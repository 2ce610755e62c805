// Hemispherical total emissivities against closed forms.
#include "core/materials/total_emissivity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/constants.h"
#include "core/spectral/planck.h"

namespace irsig {
namespace {

TEST(TotalEmissivity, OfGreyAndStepSurfaces) {
  const auto grey = total_emissivity({"grey", Lambert{{{0, 0.83}}}}, 300);
  ASSERT_TRUE(grey.ok());
  EXPECT_NEAR(grey->value, 0.83, 1e-6);
  EXPECT_EQ(grey->covered, 1);
  // 0.2 below 8 um, 0.9 above, covered from 1 to 60 um.
  const auto step =
      total_emissivity({"step", Lambert{{{1, 0.2}, {7.9999, 0.2}, {8.0001, 0.9}, {60, 0.9}}}}, 300);
  ASSERT_TRUE(step.ok());
  const double all = kStefanBoltzmannWM2K4 * std::pow(300, 4) / std::numbers::pi,
               below = planck_band_radiance_w_m2_sr(0.5, 8, 300) / all;
  EXPECT_NEAR(step->value, 0.2 * below + 0.9 * (1 - below), 0.01);
  EXPECT_NEAR(step->covered, planck_band_radiance_w_m2_sr(1, 60, 300) / all, 0.02);
  // It is another at another temperature.
  EXPECT_LT(
      total_emissivity({"step", Lambert{{{1, 0.2}, {7.9999, 0.2}, {8.0001, 0.9}, {60, 0.9}}}}, 900)
          ->value,
      0.45);
}

TEST(TotalEmissivity, OfTablesThatCoverTheBandsAlone) {
  const auto bands = total_emissivity({"bands", Lambert{{{8, 0.7}, {12, 0.9}}}}, 290);
  ASSERT_TRUE(bands.ok());
  EXPECT_NEAR(bands->covered, 0.26, 0.02);
  EXPECT_GT(bands->value, 0.7);
  EXPECT_LT(bands->value, 0.9);
}

// A dielectric's hemispherical emissivity is below its normal one; a metal's above.
TEST(TotalEmissivity, OfSmoothSurfaces) {
  const auto smooth = [](double n, double k) {
    CookTorrance lobe;
    lobe.constants = {{0, n, k}};
    lobe.roughness = 0.01;
    const auto total = total_emissivity({"smooth", lobe}, 300);
    EXPECT_TRUE(total.ok()) << total.status();
    return total->value;
  };
  // Hemispherical reflectance of a smooth dielectric of index 1.5 for unpolarised light: 0.0918.
  EXPECT_NEAR(smooth(1.5, 0), 1 - 0.0918, 0.004);
  EXPECT_GT(smooth(5, 20), 1 - ((16 + 400.0) / (36 + 400.0)));
}

}  // namespace
}  // namespace irsig
