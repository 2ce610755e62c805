// Stored images without OpenEXR: the same pixels, or nothing.
#include "view/pictures/stored_exr.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>

#include "core/image/image.h"
#include "core/image/reader/exr_reader.h"

namespace irsig {
namespace {

// Flat beside a noisy target: blocks that are packed, and blocks that are not.
RadianceImage some_image(std::uint32_t width_px, std::uint32_t height_px) {
  std::minstd_rand random(7);
  RadianceImage out{width_px, height_px, {}};
  for (std::uint32_t i = 0; i < width_px * height_px; ++i)
    out.radiance_w_m2_sr.push_back(
        i / width_px % 3 == 0 ? 12.5F : static_cast<float>(random() % 100'000) * 3.7e-4F);
  return out;
}

TEST(StoredExr, HasThePixelsThatOpenExrReads) {
  for (const auto& [width_px, height_px] :
       {std::pair{1U, 1U}, {2U, 1U}, {1U, 40U}, {33U, 17U}, {128U, 96U}}) {
    const RadianceImage image = some_image(width_px, height_px);
    for (const std::string& exr : {*encode_exr(image), *encode_error_exr(image)}) {
      const auto got = read_stored_exr(exr, 128);
      const auto expected = decode_exr(exr, 128);
      ASSERT_TRUE(got.has_value() && expected.ok()) << width_px << " x " << height_px;
      EXPECT_EQ(got->width_px, expected->width_px);
      EXPECT_EQ(got->height_px, expected->height_px);
      EXPECT_EQ(got->radiance_w_m2_sr, expected->radiance_w_m2_sr);
    }
  }
}

TEST(StoredExr, IsNothingBeyondItsLimitAndWithSeveralChannels) {
  const RadianceImage image = some_image(33, 17);
  EXPECT_FALSE(read_stored_exr(*encode_exr(image), 32).has_value());
  EXPECT_FALSE(read_stored_exr(*encode_layers_exr(33, 17, {{"a", image.radiance_w_m2_sr}}), 64));
  EXPECT_FALSE(read_stored_exr("", 64).has_value());
}

// Where the reader accepts a file with a wrong byte, OpenEXR reads the same pixels from it.
TEST(StoredExr, OfDamagedFilesIsNothingOrWhatOpenExrReads) {
  const RadianceImage image = some_image(33, 17);
  std::minstd_rand random(3);
  for (const std::string& exr : {*encode_exr(image), *encode_error_exr(image)}) {
    for (std::size_t size = 0; size < exr.size(); ++size)
      ASSERT_FALSE(read_stored_exr(std::string_view(exr).substr(0, size), 64)) << size;
    ASSERT_FALSE(read_stored_exr(exr + "x", 64));
    for (std::size_t at = 0; at < exr.size(); ++at) {
      std::string wrong = exr;
      wrong[at] = static_cast<char>(random());
      const auto got = read_stored_exr(wrong, 64);
      if (!got || at % 8 != 0) continue;
      const auto expected = decode_exr(wrong, 64);
      ASSERT_TRUE(expected.ok()) << at << ": " << expected.status();
      ASSERT_EQ(got->radiance_w_m2_sr.size(), expected->radiance_w_m2_sr.size());
      EXPECT_EQ(std::memcmp(got->radiance_w_m2_sr.data(), expected->radiance_w_m2_sr.data(),
                            4 * got->radiance_w_m2_sr.size()),
                0)
          << at;
    }
  }
}

}  // namespace
}  // namespace irsig
