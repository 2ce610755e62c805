// Rationale: the closed-form model of the ship paper is the one place where its published numbers
// can be reproduced
//   exactly; it anchors constants, unit of the exitance (pi) and the air.
// Expected: the three published peaks within 0.05 % and 0.02 um with Table 3 and ONE absorption
// coefficient (the
//   residuals of a least-squares fit are -0.035, +0.006, +0.032 %); our own arithmetic of the same
//   formula to 1e-12.
// Source: zhou2026, Table 3 and the peaks printed with its precomputation
// (tests/physics/values/precompute.csv).
#include "core/study/precompute.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/spectral/planck.h"
#include "tests/physics/reference_table.h"

namespace irsig {
namespace {

using testing::HasSubstr;

PrecomputeCase table_3(double ambient_temperature_k, double air_temperature_k) {
  return {.hot_area_m2 = 16,
          .hot_temperature_k = 400,
          .ambient_area_m2 = 2179.5,
          .ambient_temperature_k = ambient_temperature_k,
          .emissivity = 0.8,
          .reflected_exitance_w_m2_um = 0,
          .absorption_m2_kg = 1.649e-5,
          .range_m = 5000,
          .pressure_pa = 101325,
          .gas_constant_j_kg_k = 287,
          .air_temperature_k = air_temperature_k};
}

TEST(Precompute, PublishedPeaks) {
  const ReferenceTable table("precompute.csv");
  ASSERT_EQ(table.size(), 3u);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const PrecomputeCase target =
        table_3(table.number(i, "ambient_temperature_k"), table.number(i, "air_temperature_k"));
    const auto spectrum = precompute_spectrum(target, 3, 14, 0.05);
    ASSERT_TRUE(spectrum.ok()) << spectrum.status();
    ASSERT_EQ(spectrum->size(), 221u);
    const auto peak =
        std::max_element(spectrum->begin(), spectrum->end(),
                         [](const auto& a, const auto& b) { return a.value < b.value; });
    const double published = table.number(i, "spectral_intensity_w_sr_um");
    EXPECT_NEAR(peak->lambda_um, table.number(i, "lambda_um"), 0.02);
    EXPECT_NEAR(peak->value / published, 1.0, 0.0005);
    std::printf("%s: %.2f W/(sr um) at %.2f um, published %.2f (%+.3f %%)\n",
                table.text(i, "season").c_str(), peak->value, peak->lambda_um, published,
                100 * (peak->value / published - 1));
  }
}

TEST(Precompute, OwnArithmetic) {
  const ReferenceTable table("precompute.csv");
  for (std::size_t i = 0; i < table.size(); ++i) {
    PrecomputeCase target =
        table_3(table.number(i, "ambient_temperature_k"), table.number(i, "air_temperature_k"));
    const double lambda_um = table.number(i, "lambda_um");
    target.absorption_m2_kg = table.number(i, "fitted_absorption_m2_kg");
    EXPECT_NEAR(precompute_spectral_intensity_w_sr_um(target, lambda_um) /
                    table.number(i, "fitted_intensity_w_sr_um"),
                1.0, 1e-12);
    // The coefficient of each season alone gives that season's peak; it is given with 14 digits.
    target.absorption_m2_kg = table.number(i, "absorption_m2_kg");
    EXPECT_NEAR(precompute_spectral_intensity_w_sr_um(target, lambda_um) /
                    table.number(i, "spectral_intensity_w_sr_um"),
                1.0, 1e-12);
  }
}

// Eq. 12 adds (1 - eps) E to eps M, so that a target in a cavity of its own temperature (E = M) is
// black, whatever its emissivity is, and one without emission reflects A / pi E.
TEST(Precompute, ReflectedExitance) {
  PrecomputeCase target = table_3(300, 280);
  target.hot_temperature_k = 300;
  target.absorption_m2_kg = 0;
  const double radiance = planck_radiance_w_m2_sr_um(10, 300);
  target.reflected_exitance_w_m2_um = M_PI * radiance;
  for (const double emissivity : {0.0, 0.3, 1.0}) {
    target.emissivity = emissivity;
    EXPECT_NEAR(precompute_spectral_intensity_w_sr_um(target, 10) / (2195.5 * radiance), 1.0,
                1e-15);
  }
}

TEST(Precompute, UnphysicalInputIsRefusedWithEveryReason) {
  PrecomputeCase target = table_3(300, 280);
  target.emissivity = 1.2;
  target.hot_temperature_k = -1;
  target.air_temperature_k = 0;
  target.range_m = NAN;
  const auto spectrum = precompute_spectrum(target, 5, 3, 0);
  ASSERT_EQ(spectrum.status().code(), absl::StatusCode::kInvalidArgument);
  const std::string why(spectrum.status().message());
  for (const char* name : {"emissivity = 1.2", "hot_temperature_k = -1", "air_temperature_k = 0",
                           "range_m = nan", "5 to 3 um", "step_um = 0"}) {
    EXPECT_THAT(why, HasSubstr(name));
  }
}

}  // namespace
}  // namespace irsig
