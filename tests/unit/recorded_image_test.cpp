// What stands beside a recorded image lies on the imager's pixels.
#include "view/pictures/recorded_image.h"

#include <gtest/gtest.h>

#include <cmath>

#include "view/pictures/masks.h"

namespace irsig {
namespace {

// Expected: each pixel of the detector has the mean of the stored ones under it, weighted with the
// areas that they share: here by sums over cells of a tenth of a stored pixel.
TEST(RecordedImage, PartsAreAveragedOverThePixelsOfTheDetector) {
  StoredSilhouette stored{5, 4, 8, {}};
  stored.part.push_back({"hull", {}});
  stored.part.push_back({"mast", {}});
  for (std::uint32_t at = 0; at < 20; ++at)
    stored.part[0].pixel.push_back({at, static_cast<std::uint16_t>(1 + (3 * at) % 7)});
  stored.part[1].pixel.push_back({11, 1});
  const DetectorGrid grid{4, 3, 2.2, 0.5 * (5 - 4 * 2.2), 0.5 * (4 - 3 * 2.2)};
  const StoredSilhouette out = on_detector(stored, grid);
  ASSERT_EQ(out.part.size(), 2U);
  EXPECT_EQ(out.part[1].name, "mast");
  for (std::size_t p = 0; p < 2; ++p) {
    std::vector<double> expected(12, 0), got(12, 0);
    for (const StoredSilhouette::Pixel& pixel : stored.part[p].pixel)
      for (int j = 0; j < 10; ++j)
        for (int i = 0; i < 10; ++i) {
          const double x = (pixel.at % 5 + (i + 0.5) / 10 - grid.left) / grid.ratio;
          const double y = (pixel.at / 5 + (j + 0.5) / 10 - grid.top) / grid.ratio;
          expected[static_cast<std::size_t>(std::floor(y) * 4 + std::floor(x))] +=
              pixel.samples / 8.0 / 100 / (2.2 * 2.2);
        }
    for (const StoredSilhouette::Pixel& pixel : out.part[p].pixel)
      got[pixel.at] = static_cast<double>(pixel.samples) / out.pixel_samples;
    for (std::size_t i = 0; i < 12; ++i) EXPECT_NEAR(got[i], expected[i], 1.1 / 65535) << p << i;
  }
}

// A target smaller than a pixel keeps its place and its area.
TEST(RecordedImage, ASmallTargetIsAPartOfOnePixel) {
  Imager imager;
  imager.aperture_m = 0.05;
  imager.f_number = 2;
  imager.pitch_m = 15e-6;
  imager.gain = CountsOfRadiance{100, 10};
  StoredSilhouette stored{3, 3, 4, {{"drone", {{4, 4}}}}};
  RadianceImage seen{3, 3, std::vector<float>(9, 2)};
  seen.radiance_w_m2_sr[4] = 902;
  StoredSignature row{};
  row.background_radiance_w_m2_sr = 2;
  const ImagerInBand figures{4, 0, 0, 100, 10};
  const auto out = record_image(imager, figures, row, seen, imager.ifov_rad() / 9, stored);
  ASSERT_TRUE(out.ok()) << out.status();
  EXPECT_EQ(out->silhouette.width_px, 9U);
  EXPECT_EQ(covered_pixels(out->silhouette).shown_px, 1U);
  EXPECT_EQ(covered_pixels(out->silhouette).left_px, 4U);
  EXPECT_EQ(covered_pixels(out->silhouette).top_px, 4U);
  ASSERT_EQ(out->silhouette.part[0].pixel.size(), 1U);
  EXPECT_NEAR(out->silhouette.part[0].pixel[0].samples, 65535.0 / 81, 0.5);
  EXPECT_FALSE(record_image(imager, figures, row, seen, imager.ifov_rad() / 1.5, stored).ok());
}

}  // namespace
}  // namespace irsig
