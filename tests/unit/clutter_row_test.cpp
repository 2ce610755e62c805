// A measured background on its way into a message.
#include <gtest/gtest.h>

#include <cmath>

#include "core/accuracy/spectral_modes.h"
#include "messages/results/result_to_proto.h"

namespace irsig {
namespace {

// Squares of 4 x 4 pixels of two materials, which a target of 2 x 2 pixels is seen against.
ClutterField two_materials() {
  ClutterField out{64, 32, 0.5, 2, {}};
  for (std::size_t p = 0; p < out.pixels(); ++p) {
    const bool first = (p % 64 / 4 + p / 64 / 4) % 2 == 0;
    out.weight.push_back(first ? 1 : 0);
    out.weight.push_back(first ? 0 : 1);
  }
  return out;
}

TEST(ClutterRow, MessageHasTheStatisticsAndTheModes) {
  const ClutterField field = two_materials();
  const SpectralSet spectra = {{1, 2, 3}, {2, 2, 1}};
  const std::vector<double> radiance = {2, 1.5};  // of a band
  const auto statistics = clutter_of(field, radiance, 1);
  const auto modes = clutter_modes(weight_factor(field, 1), std::vector<SpectralSet>{spectra});
  const BackgroundClutter clutter =
      background_clutter(field, statistics, modes, 0, 0.9, {0.5, 0.5});
  schema::SignatureRow row;
  set_clutter(&row, clutter);
  EXPECT_EQ(row.clutter_window_m(), 32);
  EXPECT_EQ(row.clutter_pixel_m(), 0.5);
  EXPECT_EQ(row.clutter_patch_m(), 1);
  EXPECT_EQ(row.clutter_mean_w_m2_sr().value(), 1.75);
  EXPECT_EQ(row.clutter_sigma_w_m2_sr().value(), statistics.sigma.value);
  EXPECT_EQ(row.clutter_patch_sigma_w_m2_sr().stderr(), statistics.patch_sigma.stderr_);
  EXPECT_EQ(row.clutter_cells(), statistics.cells);
  EXPECT_EQ(row.visible_fraction(), 0.9);
  EXPECT_EQ(row.clutter().material_fraction_size(), 2);
  const auto& sigma = row.clutter().patch_sigma_w_m2_sr_um();
  ASSERT_EQ(sigma.size(), 3);
  EXPECT_EQ(sigma[1], 0.0F);
  const auto errors = SumErrors::make({sigma.data(), 3}, row.clutter().modes()).value();
  ASSERT_EQ(errors.modes().size(), 1U);
  // The bins' deviations are -1, 0 and 2 times half of the difference of both materials.
  EXPECT_NEAR(errors.of(std::vector<double>{1, 5, 0.25}), 0.5 * sigma[0], 1e-4);
  EXPECT_NEAR(errors.of(std::vector<double>{2, 0, 1}), 0, 1e-4);
}

// 1366 bins are too many for any mode: all of the variance stays in the rest.
TEST(ClutterRow, ModesThatDoNotFitAreLeftOut) {
  SpectralSet spectra(2, std::vector<double>(1366, 1.0));
  for (double& v : spectra[1]) v = 3;
  const ClutterField field = two_materials();
  const auto modes = clutter_modes(weight_factor(field, 0), std::vector<SpectralSet>{spectra});
  schema::SignatureRow row;
  set_clutter(&row, background_clutter(field, clutter_of(field, std::vector<double>{1, 3}, 0),
                                       modes, 0, 1, {}));
  EXPECT_EQ(row.clutter().modes(), "");
  EXPECT_NEAR(row.clutter().patch_sigma_w_m2_sr_um(5), 1, 1e-6);
}

}  // namespace
}  // namespace irsig
