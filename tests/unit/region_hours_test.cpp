// Means over regions of images through a day: the right pixels, errors and hours, and messages that
// state the remedy.
#include "view/pictures/region_hours.h"

#include <gmock/gmock.h>

#include <cmath>
#include <sstream>

#include "core/image/image.h"
#include "fake_database.h"
#include "view/pictures/image_regions.h"

namespace irsig {
namespace {

using ::testing::AllOf;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

std::string message(const absl::Status& status) { return std::string(status.message()); }

TEST(ImageRegions, RectanglesAreParsed) {
  const std::vector<std::string> good = {"lawn=1,2,3,5", "a=b=0,0,1,1"};
  const auto two = parse_rectangles(good);
  ASSERT_TRUE(two.ok()) << two.status();
  EXPECT_EQ((*two)[0].name, "lawn");
  EXPECT_EQ((*two)[0].y1_px, 5U);
  EXPECT_EQ((*two)[1].name, "a=b");
  for (const char* bad : {"lawn", "=0,0,1,1", "lawn=0,0,1", "lawn=0,0,1,1,1", "lawn=-1,0,1,1",
                          "lawn=0,0,1.5,1", "lawn=0,0,x,1", "lawn=0,0,99999999999,1", ""}) {
    const std::vector<std::string> text = {bad};
    const auto refused = parse_rectangles(text);
    EXPECT_EQ(refused.status().code(), absl::StatusCode::kInvalidArgument) << bad;
    EXPECT_THAT(message(refused.status()), HasSubstr("expected NAME=x0,y0,x1,y1")) << bad;
  }
  for (const char* empty : {"lawn=3,0,3,1", "lawn=0,4,1,2"}) {
    const std::vector<std::string> text = {empty};
    EXPECT_THAT(message(parse_rectangles(text).status()), HasSubstr("the rectangle is empty"));
  }
  const std::vector<std::string> twice = {"lawn=0,0,1,1", "wall=0,0,1,1", "lawn=1,1,2,2"};
  EXPECT_THAT(message(parse_rectangles(twice).status()),
              AllOf(HasSubstr("lawn=1,1,2,2: a region lawn is given before"),
                    HasSubstr("give each a name of its own")));
}

TEST(ImageRegions, UpperBoundsAreExclusive) {
  const std::vector<ImageRectangle> one = {{"lawn", 1, 0, 3, 2}};
  const auto regions = rectangle_regions(one, 4, 2);
  ASSERT_TRUE(regions.ok()) << regions.status();
  EXPECT_THAT((*regions)[0].pixel, ElementsAre(1, 2, 5, 6));
  EXPECT_THAT(message(rectangle_regions(one, 2, 2).status()),
              HasSubstr("lawn=1,0,3,2: reaches beyond the image of 2 x 2 pixels; x1 is at most 2 "
                        "and y1 at most 2"));
  EXPECT_FALSE(rectangle_regions(one, 4, 1).ok());
}

// Expected: errors of pixels with target in squares, those of sky and sea as one error; those of
// land in squares.
TEST(ImageRegions, MeansAndErrors) {
  const ImageRegion region{"lawn", {0, 1, 2, 3}};
  const std::vector<float> radiance = {1, 2, 4, 9, 100}, error = {3, 4, 5, 7, 100},
                           kelvin = {290, 300, 0, 0, 500}, filled = {1, 0.25F, 0, 0, 1};
  ImageNumbers image{radiance, error, kelvin, {}, filled};
  RegionMean mean = region_mean(region, image);
  EXPECT_EQ(mean.radiance_w_m2_sr, 4);
  EXPECT_NEAR(mean.stderr_w_m2_sr, std::sqrt(9.0 + 16 + 12 * 12) / 4, 1e-12);
  EXPECT_NEAR(mean.temperature_k, (290 + 0.25 * 300) / 1.25, 1e-12);
  EXPECT_NEAR(mean.target_fraction, 1.25 / 4, 1e-12);
  EXPECT_NEAR(mean.known_fraction, 1.25 / 4, 1e-12);
  image.independent_background = true;
  EXPECT_NEAR(region_mean(region, image).stderr_w_m2_sr, std::sqrt(9.0 + 16 + 25 + 49) / 4, 1e-12);
  image.stderr_w_m2_sr = {};
  image.temperature_k = {};
  mean = region_mean(region, image);
  EXPECT_TRUE(std::isnan(mean.stderr_w_m2_sr));
  EXPECT_TRUE(std::isnan(mean.temperature_k));
  const ImageRegion sky{"sky", {2, 3}};
  image.temperature_k = kelvin;
  EXPECT_TRUE(std::isnan(region_mean(sky, image).temperature_k));
  EXPECT_EQ(region_mean(sky, image).target_fraction, 0);
  // Land beside the target and behind its edge.
  const std::vector<float> land = {310, 310, 280, 0, 0};
  image.land_temperature_k = land;
  mean = region_mean(region, image);
  EXPECT_NEAR(mean.temperature_k, (290 + 0.25 * 300 + 0.75 * 310 + 280) / 3, 1e-12);
  EXPECT_NEAR(mean.known_fraction, 0.75, 1e-12);
}

std::string utc_of(int hour) {
  return (hour < 10 ? "2025-07-22T0" : "2025-07-22T") + std::to_string(hour) + ":00:00Z";
}

// Images of 3 x 2 pixels at four times in two bands: hull, half a funnel, then sky. Radiances and
// temperatures rise with the hour.
FakeDatabase day_of_images() {
  FakeSweep sweep;
  sweep.viewpoint = {{90, 10, 2000}};
  sweep.season.clear();
  for (int h = 0; h < 24; h += 6) sweep.season.push_back({"summer", utc_of(h), 1});
  FakeDatabase db = fake_database(sweep);
  schema::Sweep& stored = *db.sweeps["box ship"].resolved.mutable_sweep();
  stored.mutable_place()->set_latitude_deg(35);
  stored.mutable_place()->set_longitude_deg(135);
  stored.mutable_output()->set_thumbnail_px(3);
  for (const StoredSignature& s : db.signatures) {
    const auto hour = std::stof(s.time_utc.substr(11, 2));
    const auto layer = [&](const char* name, std::vector<float> pixels) -> schema::ImageLayer& {
      schema::ImageLayer& out = db.image_layers[s.signature_id].emplace_back();
      out.set_name(name);
      out.set_exr(*encode_exr({3, 2, std::move(pixels)}));
      return out;
    };
    layer("at_sensor", {5 + hour, 7 + hour, 1, 5 + hour, 7 + hour, 1})
        .set_stderr_exr(*encode_error_exr({3, 2, {0.5F, 0.5F, 0.25F, 0.5F, 0.5F, 0.25F}}));
    layer("sun", {1, 1, 0, 1, 1, 0});
    layer("temperature", {280 + hour, 320 + hour, 0, 280 + hour, 320 + hour, 0});
    db.silhouettes[s.signature_id] = {
        3, 2, 8, {{"hull", {{0, 8}, {3, 8}}}, {"funnel", {{1, 4}, {4, 4}}}}, {}};
    db.thumbnails[s.signature_id].set_exr("none is read");
  }
  return db;
}

// All images have the layout of irsig.
absl::StatusOr<std::vector<PictureAnswer>> read_none(const std::vector<PictureTask>& tasks) {
  std::vector<PictureAnswer> out(tasks.size());
  for (PictureAnswer& answer : out) answer.damage = "it is no EXR";
  return out;
}

absl::StatusOr<RegionHours> hours_in(FakeDatabase& db, const Query& query,
                                     const std::vector<ImageRectangle>& rectangles = {},
                                     const std::string& layer = "at_sensor") {
  return region_hours(db, query, rectangles, layer, read_none);
}

TEST(RegionHours, EachPartAndTheWholeImage) {
  FakeDatabase db = day_of_images();
  const auto hours = hours_in(db, {});
  ASSERT_TRUE(hours.ok()) << hours.status();
  ASSERT_EQ(hours->value.size(), 2U * 3U * 4U);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < hours->value.size(); i += 4) names.push_back(hours->value[i].region);
  EXPECT_THAT(names, ElementsAre("hull", "funnel", "whole image", "hull", "funnel", "whole image"));
  // 00:00 to 18:00 UTC are 09:00 to 03:00 at the place.
  const RegionValue& hull = hours->value[1];
  EXPECT_THAT(hull.at.hour, DoubleNear(15, 1e-6));
  EXPECT_EQ(hull.pixels, 2U);
  EXPECT_NEAR(hull.mean.radiance_w_m2_sr, 11, 1e-6);
  EXPECT_NEAR(hull.mean.stderr_w_m2_sr, std::sqrt(0.5) / 2, 1e-6);
  EXPECT_NEAR(hull.mean.temperature_k, 286, 1e-4);
  EXPECT_EQ(hull.mean.target_fraction, 1);
  EXPECT_EQ(hours->value[5].mean.target_fraction, 0.5);
  const RegionValue& whole = hours->value[9];
  EXPECT_NEAR(whole.mean.radiance_w_m2_sr, (2 * 11 + 2 * 13 + 2 * 1) / 6.0, 1e-6);
  EXPECT_NEAR(whole.mean.stderr_w_m2_sr, std::sqrt(4 * 0.25 + 0.25) / 6, 1e-6);
  EXPECT_NEAR(whole.mean.temperature_k, (286 + 0.5 * 326) / 1.5, 1e-4);

  const std::string svg = plot_region_hours(*hours);
  EXPECT_THAT(
      svg, AllOf(HasSubstr("Local mean solar time in h (UTC + 9.00 h)"),
                 HasSubstr("box ship, azimuth 90.0\u00b0, elevation 10.0\u00b0, range 2 km"),
                 HasSubstr(">lwir (8\u201312 \u00b5m)<"), HasSubstr("Radiance in W/(m\u00b2 sr)"),
                 HasSubstr(">Temperature in K<"), HasSubstr("\u00b1 2 standard errors"),
                 HasSubstr(">funnel, 50 %<"), HasSubstr(">hull<"), Not(HasSubstr("nan"))));
  EXPECT_EQ(count_of(svg, "<circle"), 3U * 3U * 4U);
  // A curve of radiance is drawn with both edges of its band.
  EXPECT_EQ(count_of(svg, "<polyline"), 2U * 3U * 3U + 3U);
}

TEST(RegionHours, RectanglesAndTheTable) {
  FakeDatabase db = day_of_images();
  const auto hours = hours_in(db, {.band = "lwir"}, {{"sky", 2, 0, 3, 2}, {"left", 0, 0, 1, 1}});
  ASSERT_TRUE(hours.ok()) << hours.status();
  ASSERT_EQ(hours->value.size(), 8U);
  EXPECT_NEAR(hours->value[0].mean.stderr_w_m2_sr, 0.25, 1e-6) << "sky: one error for both pixels";
  std::ostringstream csv;
  ASSERT_TRUE(write_region_hours(*hours, "csv", csv).ok());
  EXPECT_THAT(
      csv.str(),
      AllOf(HasSubstr("sweep,day,season,time_utc,solar_time_h,band,aspect_azimuth_deg,"
                      "aspect_elevation_deg,range_m,row,layer,region,region_px,radiance_w_m2_sr,"
                      "radiance_stderr_w_m2_sr,target_fraction,temperature_k"),
            HasSubstr("box ship,summer,summer,2025-07-22T00:00:00Z,9,lwir,90,10,2000,2,at_sensor,"
                      "sky,2,1,0.25,0,\n"),
            HasSubstr(",left,1,5,0.5,1,280\n")));
  EXPECT_EQ(count_of(csv.str(), "\n"), 9U);
  const std::string svg = plot_region_hours(*hours);
  EXPECT_EQ(count_of(svg, ">sky<"), 1U) << "it has no temperature";
  EXPECT_EQ(count_of(svg, ">left<"), 2U);
}

TEST(RegionHours, LayersWithoutErrorsAndWithoutTemperatures) {
  FakeDatabase db = day_of_images();
  for (auto& [id, layers] : db.image_layers) layers.pop_back();
  const auto hours = hours_in(db, {.band = "mwir"}, {}, "sun");
  ASSERT_TRUE(hours.ok()) << hours.status();
  const std::string svg = plot_region_hours(*hours);
  EXPECT_THAT(svg, AllOf(HasSubstr("layer sun"), Not(HasSubstr("standard errors")),
                         Not(HasSubstr("Temperature")), Not(HasSubstr("nan"))));
  EXPECT_EQ(count_of(svg, "<polyline"), 3U);
}

TEST(RegionHours, MessagesStateTheRemedy) {
  FakeDatabase db = day_of_images();
  EXPECT_THAT(message(hours_in(db, {.time = utc_of(6)}).status()), HasSubstr("two times or more"));
  EXPECT_THAT(message(hours_in(db, {.band = "lwir"}, {{"far", 0, 0, 4, 1}}).status()),
              HasSubstr("beyond the image of 3 x 2 pixels"));
  EXPECT_THAT(message(hours_in(db, {}, {}, "range").status()),
              AllOf(HasSubstr("--layer range: "), HasSubstr("expected one of emitted, sun,")));
  EXPECT_THAT(message(hours_in(db, {}, {}, "path").status()),
              AllOf(HasSubstr("has no layer path, it has at_sensor, sun, temperature"),
                    HasSubstr("--layer")));
  Query between;
  between.aspect = SignatureFilter::Direction{90, 10};
  between.interpolate = true;
  EXPECT_THAT(message(hours_in(db, between).status()), HasSubstr("images are not interpolated"));

  FakeDatabase damaged = day_of_images();
  damaged.image_layers.begin()->second[0].set_exr("cut off");
  const auto refused = hours_in(damaged, {});
  EXPECT_EQ(refused.status().code(), absl::StatusCode::kDataLoss);
  EXPECT_THAT(message(refused.status()), HasSubstr("image of row 1 is damaged: it is no EXR"));

  FakeDatabase plain = day_of_images();
  plain.image_layers.clear();
  EXPECT_THAT(message(hours_in(plain, {}).status()),
              AllOf(HasSubstr("computed without layers of its image: add layers = [\"at_sensor\""),
                    HasSubstr("[image]")));
  plain.thumbnails.clear();
  EXPECT_THAT(message(hours_in(plain, {}).status()), HasSubstr("computed without image: add"));

  FakeDatabase many = fake_database();
  EXPECT_THAT(message(hours_in(many, {}).status()),
              AllOf(HasSubstr("--aspect (the nearest),"), Not(HasSubstr("interpolate"))));
}

}  // namespace
}  // namespace irsig
