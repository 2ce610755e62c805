// Five pictures of one image by the effects that its light meets.
#include "view/pictures/effect_pictures.h"

#include <gmock/gmock.h>

#include <sstream>

#include "core/accuracy/image_layers.h"
#include "core/image/image.h"
#include "fake_database.h"

namespace irsig {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// One image of 4 x 2 pixels in one band; the third pixel of the upper row is sky.
FakeDatabase image_of_effects() {
  FakeSweep sweep;
  sweep.viewpoint = {{90, 10, 2000}};
  FakeDatabase db = fake_database(sweep);
  db.sweeps["box ship"].resolved.mutable_sweep()->mutable_output()->set_thumbnail_px(4);
  for (const StoredSignature& s : db.signatures) {
    const auto layer = [&](ImageLayer which, std::vector<float> pixels) {
      schema::ImageLayer& out = db.image_layers[s.signature_id].emplace_back();
      out.set_name(name_of(which));
      out.set_exr(*encode_exr({4, 2, std::move(pixels)}));
    };
    layer(ImageLayer::kAtSensor, {9, 9, 3, 9, 20, 20, 20, 30});
    layer(ImageLayer::kSun, {1, 0, 0, 0, 0, 0, 0, 4});
    layer(ImageLayer::kSky, {2, 0, 0, 0, 0, 0, 0, 1});
    layer(ImageLayer::kLandSun, {0, 4, 0, 0, 0, 0, 0, 2});
    layer(ImageLayer::kLandSky, {0, 1, 0, 0, 0, 0, 0, 3});
    layer(ImageLayer::kWithoutAir, {7, 6, 3, 9, 25, 25, 25, 40});
    db.thumbnails[s.signature_id].set_exr("none is read");
  }
  return db;
}

absl::StatusOr<std::vector<PictureAnswer>> no_pictures(const std::vector<PictureTask>& tasks) {
  std::vector<PictureAnswer> out(tasks.size());
  for (PictureAnswer& answer : out) answer.damage = "it is no EXR";
  return out;
}

const Query kOne{.season = "summer", .band = "lwir"};

// Expected: each picture is the image without what its letter leaves out, and e = c + d - b.
TEST(EffectPictures, LeaveOutWhatTheirNamesSay) {
  FakeDatabase db = image_of_effects();
  const auto pictures = effect_pictures(db, kOne, no_pictures);
  ASSERT_TRUE(pictures.ok()) << pictures.status();
  const auto& [a, b, c, d, e] = pictures->w_m2_sr;
  EXPECT_THAT(a, ElementsAre(7, 6, 3, 9, 25, 25, 25, 40));
  EXPECT_THAT(b, ElementsAre(6, 4, 3, 9, 20, 20, 20, 20));
  EXPECT_THAT(c, ElementsAre(8, 5, 3, 9, 20, 20, 20, 24));
  EXPECT_THAT(d, ElementsAre(7, 8, 3, 9, 20, 20, 20, 26));
  EXPECT_THAT(e, ElementsAre(9, 9, 3, 9, 20, 20, 20, 30));
  const auto sheet = effects_sheet(*pictures, std::nullopt);
  ASSERT_TRUE(sheet.ok()) << sheet.status();
  ASSERT_EQ(sheet->label.size(), 5u);
  EXPECT_EQ(sheet->label[4].text, "e: all");
  EXPECT_EQ(sheet->range.low, 3);
  EXPECT_EQ(sheet->range.high, 40);
  const auto narrow = effects_sheet(*pictures, ColorRange{5, 6});
  ASSERT_TRUE(narrow.ok());
  EXPECT_EQ(narrow->range.high, 6);
}

TEST(EffectPictures, TheDiagonalGoesFromCornerToCorner) {
  FakeDatabase db = image_of_effects();
  const auto pictures = effect_pictures(db, kOne, no_pictures);
  ASSERT_TRUE(pictures.ok()) << pictures.status();
  std::ostringstream csv;
  ASSERT_TRUE(write_diagonal(*pictures, "csv", csv).ok());
  EXPECT_THAT(
      csv.str(),
      AllOf(HasSubstr(",diagonal_px,x_px,y_px,without_air_w_m2_sr,emitted_w_m2_sr,"
                      "with_sky_w_m2_sr,with_sun_w_m2_sr,all_w_m2_sr"),
            HasSubstr(",lwir,0,0,0,7,6,8,7,9\n"), HasSubstr(",lwir,1,1,0,6,4,5,8,9\n"),
            HasSubstr(",lwir,2,2,1,25,20,20,20,20\n"), HasSubstr(",lwir,3,3,1,40,20,24,26,30\n")));
  EXPECT_THAT(plot_diagonal(*pictures),
              AllOf(HasSubstr("c: b and sky reflected"), HasSubstr("Pixel along the diagonal"),
                    Not(HasSubstr("nan"))));
}

TEST(EffectPictures, AMissingLayerIsNamed) {
  FakeDatabase db = image_of_effects();
  for (auto& [id, layers] : db.image_layers) layers.erase(layers.begin() + 3);
  const auto refused = effect_pictures(db, kOne, no_pictures);
  EXPECT_EQ(refused.status().code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(
      std::string(refused.status().message()),
      AllOf(HasSubstr("lacks the layers land_sun"), HasSubstr("add layers = [\"at_sensor\"")));
}

}  // namespace
}  // namespace irsig
