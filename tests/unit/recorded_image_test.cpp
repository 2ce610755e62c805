// Masks beside a recorded image lie on the imager's pixels.
#include "view/pictures/recorded_image.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/image/reader/exr_reader.h"
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

// A mast before a hull, of which a camera cuts off a part: 4 x 3 pixels of 8 rays. The hull fills
// the lower six of its pixels, the mast one of them and one above; 3 pixels of hull lie outside.
TEST(Masks, WholeObjectsHaveWhatOthersHide) {
  StoredSilhouette of{4, 3, 8, {}};
  of.part = {{"hull", {{4, 8}, {6, 8}, {8, 8}, {9, 8}, {10, 8}}}, {"mast", {{1, 8}, {5, 8}}}};
  of.part_set = {{{"hull"}, 3, {{4, 8}, {6, 8}, {8, 8}, {9, 8}, {10, 8}}},
                 {{"hull", "mast"}, 0, {{5, 8}}},
                 {{"mast"}, 0, {{1, 8}}}};
  const auto whole_of = [&](const StoredSilhouette& from, const std::string& part) {
    const auto has = [&](const std::string& name) { return part == "*" || name == part; };
    return whole_object(from, seen_object(from, has).value(), has);
  };
  const auto hull = whole_of(of, "hull");
  ASSERT_TRUE(hull.has_value());
  EXPECT_EQ(hull->mask.area_px, 6);
  EXPECT_NEAR(hull->occlusion, 1.0 / 6, 1e-12);
  EXPECT_NEAR(hull->truncation, 3.0 / 9, 1e-12);
  EXPECT_EQ(hull->mask.top_px, 1U);
  EXPECT_EQ(hull->mask.runs, (std::vector<std::uint32_t>{1, 2, 1, 2, 1, 2, 3}));
  const auto mast = whole_of(of, "mast");
  EXPECT_EQ(mast->mask.area_px, 2);
  EXPECT_EQ(mast->occlusion, 0);
  EXPECT_EQ(mast->truncation, 0);
  // Rays through both count once.
  EXPECT_EQ(whole_of(of, "*")->mask.area_px, 7);
  EXPECT_EQ(whole_of(of, "*")->occlusion, 0);
  EXPECT_NEAR(whole_of(of, "*")->truncation, 0.3, 1e-12);
  // It also holds on the pixels of an imager.
  const auto recorded = whole_of(on_detector(of, {2, 1, 2.0, 0, 0.5}), "hull");
  EXPECT_NEAR(recorded->occlusion, 1.0 / 6, 1e-4);
  EXPECT_NEAR(recorded->truncation, 3.0 / 9, 1e-4);
  of.part_set.clear();
  EXPECT_FALSE(whole_of(of, "hull").has_value());
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

// Once a frame of the row's background, of another radiance than sky and sea, lay around it.
TEST(RecordedImage, SkyAndSeaGoOnBeyondTheBorder) {
  Imager imager;
  imager.aperture_m = 0.05;
  imager.f_number = 2;
  imager.pitch_m = 15e-6;
  imager.gain = CountsOfRadiance{100, 0};
  StoredSilhouette stored{40, 30, 4, {}};
  RadianceImage seen{40, 30, {}};
  for (std::uint32_t i = 0; i < 1200; ++i) seen.radiance_w_m2_sr.push_back(i < 600 ? 200 : 300);
  StoredSignature row{};
  row.background_radiance_w_m2_sr = 0;
  const ImagerInBand figures{4, 0, 0, 100, 0};
  const auto out = record_image(imager, figures, row, seen, imager.ifov_rad() / 4, stored, true);
  ASSERT_TRUE(out.ok()) << out.status();
  const auto noiseless = decode_exr(out->noiseless_exr, 100);
  ASSERT_TRUE(noiseless.ok()) << noiseless.status();
  ASSERT_EQ(noiseless->width_px, 10U);
  ASSERT_EQ(noiseless->height_px, 8U);  // of 7.5
  // What the row's background of 0 takes away beyond eight pixels, and the tail of the point spread
  // at the horizon.
  for (std::uint32_t y = 0; y < 8; ++y)
    for (std::uint32_t x = 0; x < 10; ++x) {
      const float value = noiseless->radiance_w_m2_sr[y * 10 + x];
      EXPECT_NEAR(value, noiseless->radiance_w_m2_sr[y * 10 + 5], 2) << x << ", " << y;
      if (y == 3 || y == 4) continue;
      EXPECT_NEAR(value, y < 4 ? 200 : 300, 8) << x << ", " << y;
    }
}

}  // namespace
}  // namespace irsig
