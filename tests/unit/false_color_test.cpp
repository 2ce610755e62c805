// Rationale: a picture in false colours is read by its bar, so a pixel's colour must lead back to
// its value, and the embedded images must be PNG that others read. Expected: colour -> place on the
// bar -> value, within half of one of 255 levels; checksums as the specifications have them.
// Source: ISO/IEC 15948 (PNG), RFC 1950; their checksums of known texts.
#include "schema/store/check_picture.h"
#include "view/draw/false_color.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <tuple>

#include "absl/strings/escaping.h"
#include "core/spectral/planck.h"
#include "fake_database.h"
#include "view/draw/png.h"
#include "view/draw/svg.h"
#include "view/pictures/plot_picture.h"

namespace irsig {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

std::uint32_t u32(const std::string& bytes, std::size_t at) {
  std::uint32_t out = 0;
  for (std::size_t i = 0; i < 4; ++i) out = out << 8 | static_cast<std::uint8_t>(bytes.at(at + i));
  return out;
}

using Color = std::tuple<int, int, int, int>;  // red, green, blue, opacity

struct Png {
  std::uint32_t width = 0, height = 0;
  std::vector<Color> pixel;
};

// Of palette images with one stored block for each 65535 bytes.
Png read_png(const std::string& bytes) {
  Png out;
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x89PNG\r\n\x1a\n", 8));
  std::vector<Color> palette;
  for (std::size_t at = 8; at < bytes.size();) {
    const std::size_t size = u32(bytes, at);
    const std::string type = bytes.substr(at + 4, 4), data = bytes.substr(at + 8, size);
    at += 12 + size;
    const auto byte = [&](std::size_t i) { return int{static_cast<std::uint8_t>(data.at(i))}; };
    if (type == "IHDR") {
      out.width = u32(data, 0);
      out.height = u32(data, 4);
    } else if (type == "PLTE") {
      for (std::size_t i = 0; i < size; i += 3)
        palette.emplace_back(byte(i), byte(i + 1), byte(i + 2), 255);
    } else if (type == "tRNS") {
      for (std::size_t i = 0; i < size; ++i) std::get<3>(palette.at(i)) = byte(i);
    } else if (type == "IDAT") {
      std::string rows;
      for (std::size_t i = 2; i < size - 4;) {
        const auto length = static_cast<std::size_t>(byte(i + 1) | byte(i + 2) << 8);
        EXPECT_EQ(length ^ 0xFFFF, static_cast<std::size_t>(byte(i + 3) | byte(i + 4) << 8));
        rows += data.substr(i + 5, length);
        i += 5 + length;
      }
      EXPECT_EQ(rows.size(), static_cast<std::size_t>(out.height) * (out.width + 1));
      for (std::size_t i = 0; i < rows.size(); ++i)
        if (i % (out.width + 1) != 0)
          out.pixel.push_back(palette.at(static_cast<std::uint8_t>(rows[i])));
    }
  }
  EXPECT_EQ(out.pixel.size(), static_cast<std::size_t>(out.width) * out.height);
  return out;
}

// The colour in the middle of a pixel of the picture, which is enlarged.
Color color_at(const Png& png, const FalseColorPicture& picture, std::size_t pixel) {
  const std::size_t times = png.width / picture.width_px;
  EXPECT_EQ(png.width, times * picture.width_px);
  EXPECT_EQ(png.height, times * picture.height_px);
  const std::size_t x = pixel % picture.width_px, y = pixel / picture.width_px;
  return png.pixel.at((y * times + times / 2) * png.width + x * times + times / 2);
}

std::vector<Png> images_of(const std::string& svg) {
  std::vector<Png> out;
  const std::string begin = "base64,";
  for (std::size_t at = svg.find(begin); at != std::string::npos; at = svg.find(begin, at + 1)) {
    const std::size_t from = at + begin.size();
    std::string bytes;
    EXPECT_TRUE(absl::Base64Unescape(svg.substr(from, svg.find('"', from) - from), &bytes));
    out.push_back(read_png(bytes));
  }
  return out;
}

FalseColorPicture picture_of(std::vector<float> values, std::uint32_t width) {
  FalseColorPicture out;
  out.width_px = width;
  out.height_px = static_cast<std::uint32_t>(values.size()) / width;
  out.value = std::move(values);
  out.range = *range_of(out.value);
  out.axis = bar_axis("Temperature in K", out.range);
  return out;
}

TEST(Png, HasTheChecksumsOfItsSpecification) {
  const std::string png = encode_palette_png(2, 1, {0, 1}, {{1, 2, 3}, {4, 5, 6}}, 1);
  // The last chunk of every PNG: no data, and the CRC of "IEND".
  EXPECT_EQ(u32(png, png.size() - 4), 0xAE426082U);
  // Adler-32 of the bytes 0 0 1: a = 2, b = 1 + 1 + 2.
  EXPECT_THAT(png, HasSubstr(std::string("\x00\x04\x00\x02", 4)));
  const Png back = read_png(png);
  EXPECT_EQ(back.pixel, (std::vector<Color>{{1, 2, 3, 255}, {4, 5, 6, 0}}));
}

TEST(FalseColor, AColourLeadsBackToItsValueByTheBar) {
  std::vector<float> values;
  for (int i = 0; i < 400; ++i) values.push_back(280 + 0.1F * static_cast<float>((i * 37) % 400));
  values[17] = kNothing;
  const FalseColorPicture picture = picture_of(values, 20);
  EXPECT_FLOAT_EQ(static_cast<float>(picture.range.low), 280);
  EXPECT_FLOAT_EQ(static_cast<float>(picture.range.high), 319.9F);
  const auto images = images_of(draw_false_color(picture));
  ASSERT_EQ(images.size(), 2U);
  const Png &pixels = images[0], &bar = images[1];
  ASSERT_EQ(bar.height, 255U);
  EXPECT_EQ(std::set<Color>(bar.pixel.begin(), bar.pixel.end()).size(), 255U)
      << "each colour stands for one value";
  const double level = (picture.range.high - picture.range.low) / 255;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i == 17) {
      EXPECT_EQ(std::get<3>(color_at(pixels, picture, i)), 0) << "transparent";
      continue;
    }
    const auto found = std::find(bar.pixel.begin(), bar.pixel.end(), color_at(pixels, picture, i));
    ASSERT_NE(found, bar.pixel.end());
    const auto from_top = static_cast<double>(found - bar.pixel.begin()) + 0.5;
    EXPECT_NEAR(picture.range.high - from_top * level, static_cast<double>(values[i]),
                0.5 * level + 1e-4);
  }
}

TEST(FalseColor, WhatIsBeyondTheScaleHasTheColourOfItsEnd) {
  FalseColorPicture picture = picture_of({200, 300, 400}, 3);
  picture.range = *parse_color_range("290,310");
  const auto images = images_of(draw_false_color(picture));
  EXPECT_EQ(images[0].pixel.front(), images[1].pixel.back());
  EXPECT_EQ(images[0].pixel.back(), images[1].pixel.front());
  for (const char* wrong : {"", "1", "3,1", "1,1", "a,2", "1,2,3", "1,inf"})
    EXPECT_EQ(parse_color_range(wrong).status().code(), absl::StatusCode::kInvalidArgument)
        << wrong;
}

TEST(FalseColor, OneValueAndNoValue) {
  const FalseColorPicture one = picture_of({300, kNothing}, 2);
  EXPECT_LT(one.range.low, 300);
  EXPECT_GT(one.range.high, 300);
  EXPECT_THAT(draw_false_color(one), Not(HasSubstr("nan")));
  EXPECT_EQ(range_of({kNothing}).status().code(), absl::StatusCode::kNotFound);
}

absl::StatusOr<std::vector<PictureAnswer>> pixels(std::uint32_t width_px, std::uint32_t height_px,
                                                  std::vector<float> pixel) {
  std::vector<PictureAnswer> out(1);
  out[0].width_px = width_px;
  out[0].height_px = height_px;
  out[0].pixel = std::move(pixel);
  return out;
}

// A hot and a cold pixel of target and one of background.
struct Stored {
  FakeDatabase db = fake_database();
  ReadPictures read = [](const std::vector<PictureTask>& tasks) {
    EXPECT_EQ(tasks.front().exr, "the image");
    EXPECT_EQ(tasks.front().most_px, kMostPixels) << "the sweep does not state it";
    return pixels(3, 1, {0, 30, 60});
  };
  Stored() {
    for (auto& s : db.signatures) {
      db.thumbnails[s.signature_id].set_exr("the image");
      db.thumbnails[s.signature_id].set_pixel_rad(1 / s.range_m);  // 1 m
      s.target_paths = 1000;
      s.projected_area_m2 = 2;
    }
  }
};

TEST(RadiancePicture, HasRadianceAndApparentTemperatureBesideEachOther) {
  Stored stored;
  const auto picture = radiance_picture(stored.db, {.row = 2}, {}, {}, stored.read);
  ASSERT_TRUE(picture.ok()) << picture.status();
  EXPECT_TRUE(std::isnan(picture->value[0])) << "nothing of the target";
  EXPECT_EQ(picture->range.low, 30);
  EXPECT_EQ(picture->range.high, 60);
  ASSERT_TRUE(picture->other);
  ASSERT_GT(picture->other->at.size(), 4U);
  for (std::size_t i = 0; i < picture->other->at.size(); ++i)
    EXPECT_NEAR(apparent_temperature_k(8, 12, picture->other->at[i]),
                std::stod(picture->other->label[i]), 1e-6);
  const std::string svg = draw_false_color(*picture);
  EXPECT_THAT(svg, AllOf(HasSubstr("In-band radiance in W/(m\u00b2 sr)"),
                         HasSubstr("Apparent temperature in K"), HasSubstr(">30</text>"),
                         HasSubstr(">60</text>"), HasSubstr("lwir (8\u201312 \u00b5m)")));
  const auto scaled = radiance_picture(stored.db, {.row = 2}, ColorRange{20, 80}, {}, stored.read);
  ASSERT_TRUE(scaled.ok());
  EXPECT_EQ(scaled->range.high, 80);
}

// Pixels at an edge are covered in part: dark there, or bright where a path has met little.
TEST(RadiancePicture, TheScaleIsOfPixelsThatAreCovered) {
  Stored stored;
  for (auto& s : stored.db.signatures) s.target_paths = 100000;
  stored.read = [](const std::vector<PictureTask>&) {
    return pixels(4, 4, {0, 5, 5, 0, 5, 30, 40, 5, 5, 35, 50, 900, 5, 5, 5, 5});
  };
  const auto picture = radiance_picture(stored.db, {.row = 2}, {}, {}, stored.read);
  ASSERT_TRUE(picture.ok()) << picture.status();
  // Of the inner four, those beside a corner without a path are not sure to be covered.
  EXPECT_EQ(picture->range.low, 35);
  EXPECT_EQ(picture->range.high, 50);
  EXPECT_THAT(picture->subtitle, HasSubstr("edges are covered in part"));
}

TEST(RadiancePicture, TheTemperaturesOfABandWithAResponseAreItsOwn) {
  Stored stored;
  schema::Band& band = *stored.db.sweeps["box ship"].resolved.mutable_sweep()->mutable_band(1);
  for (const double lambda_um : {8.0, 12.0}) {
    schema::SpectralPoint& p = *band.add_response();
    p.set_lambda_um(lambda_um);
    p.set_value(0.5);
  }
  const auto picture = radiance_picture(stored.db, {.row = 2}, {}, {}, stored.read);
  ASSERT_TRUE(picture.ok()) << picture.status();
  for (std::size_t i = 0; i < picture->other->at.size(); ++i)
    EXPECT_NEAR(apparent_temperature_k(8, 12, 2 * picture->other->at[i]),
                std::stod(picture->other->label[i]), 1e-3);
}

TEST(RadiancePicture, PixelsAreAveragedWhereFewerAreWanted) {
  Stored stored;
  stored.read = [](const std::vector<PictureTask>&) {
    std::vector<float> pixel;
    for (int i = 0; i < 20; ++i)
      pixel.push_back(i % 5 < 4 && (i / 5 + i % 5) % 2 == 0 ? 60.0F : 0.0F);
    return pixels(5, 4, pixel);
  };
  const auto picture = radiance_picture(stored.db, {.row = 2}, {}, 3, stored.read);
  ASSERT_TRUE(picture.ok()) << picture.status();
  EXPECT_EQ(picture->width_px, 3U);
  EXPECT_EQ(picture->height_px, 2U);
  for (const std::size_t i : {0U, 1U, 3U, 4U}) EXPECT_EQ(picture->value[i], 30);
  EXPECT_TRUE(std::isnan(picture->value[2])) << "nothing of the target";
  const auto as_stored = radiance_picture(stored.db, {.row = 2}, {}, {}, stored.read);
  ASSERT_TRUE(as_stored.ok());
  EXPECT_EQ(as_stored->width_px, 5U);
  EXPECT_EQ(as_stored->value[0], 60);
  EXPECT_EQ(radiance_picture(stored.db, {.row = 2}, {}, 6, stored.read).status().code(),
            absl::StatusCode::kInvalidArgument);
}

TEST(RadiancePicture, IsOfOneRowWithAnImage) {
  Stored stored;
  const auto several = radiance_picture(stored.db, {.band = "lwir"}, {}, {}, stored.read);
  EXPECT_EQ(several.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(several.status().message()), HasSubstr("choose one"));
  stored.db.thumbnails.clear();
  EXPECT_EQ(radiance_picture(stored.db, {.row = 2}, {}, {}, stored.read).status().code(),
            absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace irsig
