#include "core/image/image.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "core/image/reader/exr_reader.h"

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
  const absl::StatusOr<RadianceImage> back = decode_exr(*bytes, 4096);
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(back->width_px, 128u);
  EXPECT_EQ(back->height_px, 48u);
  EXPECT_EQ(back->radiance_w_m2_sr, image.radiance_w_m2_sr);
}

// Rounded up, by no more than is said.
TEST(Image, ErrorsAreKeptToSixPerCent) {
  RadianceImage image{61, 35, {}};
  for (int i = 0; i < 61 * 35; ++i)
    image.radiance_w_m2_sr.push_back(i % 7 == 0 ? 0 : std::exp(0.02f * static_cast<float>(i) - 20));
  const absl::StatusOr<std::string> bytes = encode_error_exr(image);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  EXPECT_LT(bytes->size(), encode_exr(image)->size() / 3);
  const absl::StatusOr<RadianceImage> back = decode_exr(*bytes, 4096);
  ASSERT_TRUE(back.ok()) << back.status();
  ASSERT_EQ(back->width_px, 61u);
  ASSERT_EQ(back->height_px, 35u);
  float widest = 1;
  for (std::size_t i = 0; i < image.radiance_w_m2_sr.size(); ++i) {
    const float given = image.radiance_w_m2_sr[i], got = back->radiance_w_m2_sr[i];
    EXPECT_GE(got, given);
    EXPECT_LE(got, 1.0625f * given);
    if (given > 0) widest = std::max(widest, got / given);
  }
  EXPECT_GT(widest, 1.05f);
}

// The file that OpenImageIO writes, with a fixed date for the present time.
std::string written_by_openimageio(const char* name, const RadianceImage& image,
                                   OIIO::TypeDesc type, const void* pixels) {
  OIIO::ImageSpec spec(static_cast<int>(image.width_px), static_cast<int>(image.height_px), 1,
                       type);
  spec.channelnames = {"Y"};
  if (type == OIIO::TypeDesc::FLOAT) {
    spec.attribute("compression", "rle");
    spec.attribute("DateTime", "1970:01:01 00:00:00");
  }
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(name);
  OIIO::Filesystem::IOVecOutput memory;
  EXPECT_TRUE(output && output->set_ioproxy(&memory) && output->open(name, spec) &&
              output->write_image(type, pixels) && output->close());
  return {memory.buffer().begin(), memory.buffer().end()};
}

// Returns the pixels of a PNG of 16 bits as OpenImageIO reads them.
std::vector<std::uint16_t> read_by_openimageio(const std::string& png) {
  OIIO::Filesystem::IOMemReader memory(const_cast<char*>(png.data()), png.size());
  const auto input = OIIO::ImageInput::open("a.png", nullptr, &memory);
  if (!input) return {};
  std::vector<std::uint16_t> out(input->spec().image_pixels());
  EXPECT_TRUE(input->read_image(0, 0, 0, 1, OIIO::TypeDesc::UINT16, out.data()));
  return out;
}

// Another implementation of both formats: OpenEXR and libpng, behind OpenImageIO. Sizes from one
// pixel to several windows of deflate; noise, runs, steps, smooth shapes and nothing at all.
TEST(Image, TheBytesAreThoseOfOpenImageIO) {
  std::mt19937 random(20251127);
  const auto below = [&](std::uint32_t limit) {
    return static_cast<std::uint32_t>(random() % limit);
  };
  for (int round = 0; round < 200; ++round) {
    const std::uint32_t width = 1 + below(round % 7 == 0 ? 500 : round % 3 == 0 ? 9 : 140);
    const std::uint32_t height = 1 + below(round % 5 == 0 ? 9 : 70), kind = below(5);
    RadianceImage image{width, height, {}};
    std::vector<unsigned char> grey;
    for (std::uint32_t y = 0; y < height; ++y)
      for (std::uint32_t x = 0; x < width; ++x) {
        const double wave = 128 + 120 * std::sin(0.02 * static_cast<double>(x * y));
        const std::uint32_t value = kind == 0   ? below(256)
                                    : kind == 1 ? below(2) * 255
                                    : kind == 2 ? x / 16 % 256
                                    : kind == 3 ? static_cast<std::uint32_t>(wave)
                                                : 0;
        grey.push_back(static_cast<unsigned char>(value));
        image.radiance_w_m2_sr.push_back(static_cast<float>(value));
      }
    SCOPED_TRACE(testing::Message() << width << " x " << height << " pixels of kind " << kind);
    EXPECT_TRUE(encode_exr(image).value() == written_by_openimageio("a.exr", image,
                                                                    OIIO::TypeDesc::FLOAT,
                                                                    image.radiance_w_m2_sr.data()));
    EXPECT_TRUE(encode_png(image, {0, 255}).value() ==
                written_by_openimageio("a.png", image, OIIO::TypeDesc::UINT8, grey.data()));
    std::vector<std::uint16_t> deep;
    for (const unsigned char g : grey) deep.push_back(static_cast<std::uint16_t>(g * 200 + 7));
    EXPECT_TRUE(encode_grey_png(width, height, deep, 16).value() ==
                written_by_openimageio("a.png", image, OIIO::TypeDesc::UINT16, deep.data()));
    const auto fast = encode_grey_png(width, height, deep, 16, PngPacking::kFast);
    EXPECT_TRUE(read_by_openimageio(fast.value()) == deep);
  }
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
  EXPECT_EQ(decode_exr("no image", 4096).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_FALSE(decode_exr(encode_exr(ship())->substr(0, 200), 4096).ok());
}

// An EXR of 1.6 MB that stated 20 000 x 20 000 pixels took 4.7 GB.
TEST(Image, DecodesNoMorePixelsThanAreAllowed) {
  const RadianceImage image = ship();
  const std::uint32_t side = std::max(image.width_px, image.height_px);
  std::string exr = *encode_exr(image);
  EXPECT_TRUE(decode_exr(exr, side).ok());
  EXPECT_THAT(std::string(decode_exr(exr, side - 1).status().message()),
              HasSubstr("expected sides of at most " + std::to_string(side - 1)));
  const std::string field = std::string("dataWindow\0box2i\0", 17);
  const std::size_t window = exr.find(field) + field.size() + 4;
  const std::int32_t last[2] = {19999, 19999};
  exr.replace(window + 8, sizeof last, reinterpret_cast<const char*>(last), sizeof last);
  exr.append(20000 * 8, '\0');  // where its lines would be
  EXPECT_THAT(std::string(decode_exr(exr, 4096).status().message()),
              HasSubstr("states 20000 x 20000 pixels, expected sides of at most 4096"));
}

// Pixels wholly, in part and not at all filled by a target.
TEST(Image, ATargetIsSeenBeforeItsBackground) {
  const RadianceImage image{3, 1, {2, 0.5f, 0}};
  const auto seen = seen_from(image, {0.5, 0.25, 3, {1, 0.25f, 0}});
  ASSERT_TRUE(seen.ok()) << seen.status();
  EXPECT_THAT(seen->radiance_w_m2_sr,
              testing::ElementsAre(1.25f, 0.25f * 0.25f + 0.25f + 0.75f * 3, 3.0f));
  EXPECT_FALSE(seen_from(image, {0.5, 0.25, 3, {1, 0.25f}}).ok());
}

TEST(Image, ContentIsTheBoxOfWhatIsShown) {
  RadianceImage image{6, 5, std::vector<float>(30, 0.0f)};
  EXPECT_EQ(content_of(image).shown_px, 0u);
  EXPECT_EQ(content_of(image).width_px, 0u);
  image.radiance_w_m2_sr[6 * 1 + 4] = 2;
  image.radiance_w_m2_sr[6 * 3 + 2] = 1;
  const ImageContent content = content_of(image);
  EXPECT_EQ(content.hottest_w_m2_sr, 2);
  EXPECT_EQ(content.shown_px, 2u);
  EXPECT_EQ(content.left_px, 2u);
  EXPECT_EQ(content.top_px, 1u);
  EXPECT_EQ(content.width_px, 3u);
  EXPECT_EQ(content.height_px, 3u);
}

}  // namespace
}  // namespace irsig
