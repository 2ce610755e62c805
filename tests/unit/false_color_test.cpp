// Rationale: a picture in false colours is read by its bar, so a pixel's colour must lead back to
// its value, and the embedded images must be PNG that others read. Expected: colour -> place on the
// bar -> value, within half of one of 255 levels; checksums as the specifications have them.
// Source: ISO/IEC 15948 (PNG), RFC 1950; their checksums of known texts.
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
#include "schema/store/check/check_picture.h"
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

// Reads palette images with one stored block for each 65535 bytes.
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

// One part that 8 samples of each pixel meet so often.
StoredSilhouette filled(std::uint32_t width_px, std::uint32_t height_px,
                        const std::vector<std::uint16_t>& samples) {
  StoredSilhouette out{width_px, height_px, 8, {{"hull", {}}}};
  for (std::uint32_t i = 0; i < samples.size(); ++i)
    if (samples[i] > 0) out.part[0].pixel.push_back({i, samples[i]});
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
      s.plume_w_sr = std::numeric_limits<double>::quiet_NaN();
    }
    show(filled(3, 1, {0, 8, 8}));
  }
  void show(const StoredSilhouette& silhouette) {
    for (const auto& s : db.signatures) db.silhouettes[s.signature_id] = silhouette;
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
    EXPECT_NEAR(radiance_temperature_k(8, 12, picture->other->at[i]),
                std::stod(picture->other->label[i]), 1e-6);
  const std::string svg = draw_false_color(*picture);
  EXPECT_THAT(svg, AllOf(HasSubstr("In-band radiance in W/(m\u00b2 sr)"),
                         HasSubstr("Apparent temperature in K"), HasSubstr(">30</text>"),
                         HasSubstr(">60</text>"), HasSubstr("lwir (8\u201312 \u00b5m)")));
  const auto scaled = radiance_picture(stored.db, {.row = 2}, ColorRange{20, 80}, {}, stored.read);
  ASSERT_TRUE(scaled.ok());
  EXPECT_EQ(scaled->range.high, 80);
}

// Pixels that are filled in part show the target's own radiance, or nothing of it; a target smaller
// than a pixel is shown all the same; gas has no silhouette.
TEST(RadiancePicture, PixelsShowTheTargetAlone) {
  Stored stored;
  stored.read = [](const std::vector<PictureTask>&) { return pixels(3, 1, {30, 15, 10}); };
  stored.show(filled(3, 1, {8, 4, 3}));
  const auto picture = radiance_picture(stored.db, {.row = 2}, {}, {}, stored.read);
  ASSERT_TRUE(picture.ok()) << picture.status();
  EXPECT_EQ(picture->value[0], 30);
  EXPECT_EQ(picture->value[1], 30);
  EXPECT_TRUE(std::isnan(picture->value[2]));
  stored.show(filled(3, 1, {0, 2, 1}));
  const auto small = radiance_picture(stored.db, {.row = 2}, {}, {}, stored.read);
  ASSERT_TRUE(small.ok()) << small.status();
  EXPECT_TRUE(std::isnan(small->value[0]));
  EXPECT_EQ(small->value[1], 60);
  EXPECT_EQ(small->value[2], 80);
  for (auto& s : stored.db.signatures) s.plume_w_sr = 1;
  const auto gas = radiance_picture(stored.db, {.row = 2}, {}, {}, stored.read);
  ASSERT_TRUE(gas.ok()) << gas.status();
  EXPECT_THAT(gas->value, testing::ElementsAre(30, 15, 10));
  stored.show(filled(1, 3, {0, 2, 1}));
  EXPECT_EQ(radiance_picture(stored.db, {.row = 2}, {}, {}, stored.read).status().code(),
            absl::StatusCode::kDataLoss);
}

// One pixel of 400 is hot.
TEST(RadiancePicture, AHotPixelLeavesTheOthersTheirColours) {
  Stored stored;
  stored.read = [](const std::vector<PictureTask>&) {
    std::vector<float> pixel;
    for (int i = 0; i < 400; ++i) pixel.push_back(30 + 0.01f * static_cast<float>(i));
    pixel[57] = 9000;
    return pixels(20, 20, pixel);
  };
  stored.show(filled(20, 20, std::vector<std::uint16_t>(400, 8)));
  const auto picture = radiance_picture(stored.db, {.row = 2}, {}, {}, stored.read);
  ASSERT_TRUE(picture.ok()) << picture.status();
  EXPECT_NEAR(picture->range.low, 30.04, 0.011);
  EXPECT_NEAR(picture->range.high, 33.96, 0.011);
  EXPECT_THAT(picture->subtitle, HasSubstr("1st to the 99th percentile"));
}

TEST(SheetPicture, HasEachImageWithWhatIsItsOwn) {
  Stored stored;
  stored.read = [](const std::vector<PictureTask>& tasks) {
    std::vector<PictureAnswer> out;
    for (std::size_t i = 0; i < tasks.size(); ++i)
      out.push_back(pixels(3, 1, {0, 30, 30 + 10 * static_cast<float>(i)})->front());
    return out;
  };
  Query few{.band = "lwir"};
  few.aspect = SignatureFilter::Direction{0, 10};
  few.nearest = 5;
  const auto sheet = sheet_picture(stored.db, few, {}, {}, stored.read);
  ASSERT_TRUE(sheet.ok()) << sheet.status();
  const auto rows = run_query(stored.db, few);
  ASSERT_TRUE(rows.ok());
  ASSERT_GT(rows->size(), 1U);
  EXPECT_EQ(sheet->label.size(), rows->size());
  std::size_t shown = 0;
  for (const float v : sheet->value) shown += std::isnan(v) ? 0 : 1;
  EXPECT_EQ(shown, 2 * rows->size());
  EXPECT_THAT(draw_false_color(*sheet), HasSubstr(sheet->label[0].text + "</text>"));
  // Labels have the differences, and the title has the common values.
  EXPECT_THAT(sheet->title, HasSubstr("range "));
  for (auto& s : stored.db.signatures) s.range_m *= 1 + 1e-3 * static_cast<double>(s.row);
  const auto ranges = sheet_picture(stored.db, few, {}, {}, stored.read);
  ASSERT_TRUE(ranges.ok()) << ranges.status();
  EXPECT_THAT(ranges->title, testing::Not(HasSubstr("range ")));
  EXPECT_THAT(ranges->label[0].text, HasSubstr("range "));
  few.band.clear();
  const auto mixed = sheet_picture(stored.db, few, {}, {}, stored.read);
  EXPECT_THAT(std::string(mixed.status().message()), HasSubstr("one sweep and band"));
  const auto many = sheet_picture(stored.db, {.band = "lwir"}, {}, {}, stored.read);
  EXPECT_THAT(std::string(many.status().message()), HasSubstr("expected at most 200"));
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
    EXPECT_NEAR(radiance_temperature_k(8, 12, 2 * picture->other->at[i]),
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
  std::vector<std::uint16_t> samples;
  for (int i = 0; i < 20; ++i) samples.push_back(i % 5 < 4 && (i / 5 + i % 5) % 2 == 0 ? 8 : 0);
  stored.show(filled(5, 4, samples));
  const auto picture = radiance_picture(stored.db, {.row = 2}, {}, 3, stored.read);
  ASSERT_TRUE(picture.ok()) << picture.status();
  EXPECT_EQ(picture->width_px, 3U);
  EXPECT_EQ(picture->height_px, 2U);
  for (const std::size_t i : {0U, 1U, 3U, 4U}) EXPECT_EQ(picture->value[i], 60);
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
