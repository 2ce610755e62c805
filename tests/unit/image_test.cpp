#include "core/image/image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

namespace irsig {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

RadianceImage ship() {
  RadianceImage image{128, 48, {}};
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 128; ++x) {
      const float radiance = 30 + 5 * std::sin(0.7f * static_cast<float>(x * y));
      image.radiance_w_m2_sr.push_back(std::hypot(x - 64, 2 * (y - 24)) < 50 ? radiance : 0);
    }
  }
  return image;
}

TEST(Image, ExrKeepsEveryBitOfThePixels) {
  const RadianceImage image = ship();
  const absl::StatusOr<std::string> bytes = encode_exr(image);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const absl::StatusOr<RadianceImage> back = decode_exr(*bytes);
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(back->width_px, 128u);
  EXPECT_EQ(back->height_px, 48u);
  EXPECT_EQ(back->radiance_w_m2_sr, image.radiance_w_m2_sr);
}

// Both writers would store the time of day, to the second, if they were let.
TEST(Image, BytesDoNotDependOnTheTimeOfDay) {
  const RadianceImage image = ship();
  const std::string exr = encode_exr(image).value(), png = encode_png(image).value();
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  EXPECT_TRUE(encode_exr(image).value() == exr);
  EXPECT_TRUE(encode_png(image).value() == png);
}

TEST(Image, BytesNameNoProgramAndNoHost) {
  for (const std::string& bytes : {encode_exr(ship()).value(), encode_png(ship()).value()}) {
    for (const char* mark : {"OpenImageIO", "OIIO", "Software", "HostComputer", "tEXt", "tIME"})
      EXPECT_THAT(bytes, Not(HasSubstr(mark)));
  }
}

// The stored rows of a PNG file of one row: deflated, so compare through sizes and equality only;
// the mapping itself shows in which images encode alike.
TEST(Image, PngIsLinearFromZeroToTheLargest) {
  const auto png = [](std::vector<float> row) {
    RadianceImage image{static_cast<std::uint32_t>(row.size()), 1, std::move(row)};
    return encode_png(image).value();
  };
  EXPECT_EQ(png({0, 51, 102, 255}), png({0, 0.2f, 0.4f, 1}));  // scale does not matter
  EXPECT_EQ(png({-7, 51, 255}), png({0, 51, 255}));            // below zero is black
  EXPECT_NE(png({0, 51, 255}), png({0, 52, 255}));             // one of 255 steps is seen
  EXPECT_NE(png({0, 51, 255}), png({1, 51, 255}));             // black is 0, not the smallest
  EXPECT_EQ(png({0, 0, 0}), png({-1, -2, 0}));                 // nothing to see: black, no 0/0
}

TEST(Image, RefusesWhatIsNoImage) {
  RadianceImage image = ship();
  image.radiance_w_m2_sr[7] = std::numeric_limits<float>::quiet_NaN();
  for (const RadianceImage& bad :
       {image, RadianceImage{}, RadianceImage{0, 5, {}}, RadianceImage{2, 2, {1, 2, 3}}}) {
    EXPECT_EQ(encode_exr(bad).status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_EQ(encode_png(bad).status().code(), absl::StatusCode::kInvalidArgument);
  }
  EXPECT_EQ(decode_exr("no image").status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_FALSE(decode_exr(encode_exr(ship())->substr(0, 200)).ok());
}

}  // namespace
}  // namespace irsig
