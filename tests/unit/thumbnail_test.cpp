// Stored images as files of the user's: which row, whole or not, on which scale.
#include "view/pictures/thumbnail.h"

#include <gmock/gmock.h>

#include <cstdio>
#include <fstream>
#include <sstream>

#include "core/image/image.h"
#include "core/image/reader/exr_reader.h"
#include "fake_database.h"
#include "view/query/query.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

TEST(Thumbnail, WantsOneRowAndAKnownEnding) {
  FakeDatabase db = fake_database();
  const std::string path = ::testing::TempDir() + "irsig_thumbnail_test.png";
  const std::string png = *encode_png({2, 1, {0.0f, 1.0f}});
  db.thumbnails[db.signatures[4].signature_id].set_png(png);
  auto one = run_query(db, {.row = 5});
  auto many = run_query(db, {.season = "winter"});
  ASSERT_TRUE(one.ok() && many.ok());
  EXPECT_TRUE(write_thumbnail(db, *one, path).ok());
  std::ifstream in(path);
  std::stringstream bytes;
  bytes << in.rdbuf();
  EXPECT_EQ(bytes.str(), png);
  std::remove(path.c_str());
  EXPECT_EQ(write_thumbnail(db, *one, "a.jpg").code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(write_thumbnail(db, *many, path).message()),
              HasSubstr("382 signatures match, choose one:\n  --row 1:"));
  auto without = run_query(db, {.row = 6});
  EXPECT_EQ(write_thumbnail(db, *without, path).code(), absl::StatusCode::kNotFound);
  EXPECT_FALSE(std::ifstream(path).good());
}

// Answers tasks as irsig-picture does.
absl::StatusOr<std::vector<PictureAnswer>> read_here(const std::vector<PictureTask>& tasks) {
  std::vector<PictureAnswer> out;
  for (const PictureTask& task : tasks) {
    PictureAnswer& answer = out.emplace_back();
    const auto image = decode_exr(task.exr, task.most_px);
    if (!image.ok()) {
      answer.damage = std::string(image.status().message());
      continue;
    }
    answer.hottest_w_m2_sr = content_of(*image).hottest_w_m2_sr;
    if (task.paint) answer.png = *encode_png(*image, {task.black_w_m2_sr, task.white_w_m2_sr});
  }
  return out;
}

void allow_images(FakeDatabase& db) {
  for (auto& [name, sweep] : db.sweeps)
    sweep.resolved.mutable_sweep()->mutable_output()->set_thumbnail_px(4);
}

// Once written as it was, with exit code 0.
TEST(Thumbnail, ThatIsDamagedIsNotWritten) {
  FakeDatabase db = fake_database();
  const std::string path = ::testing::TempDir() + "irsig_damaged_test";
  const auto one = run_query(db, {.row = 5});
  ASSERT_TRUE(one.ok());
  allow_images(db);
  const RadianceImage image{2, 2, {0.0f, 1.0f, 2.0f, 3.0f}};
  schema::Thumbnail& stored = db.thumbnails[db.signatures[4].signature_id];
  const auto refused = [&](const std::string& ending, const std::string& scale) {
    const absl::Status status = write_thumbnail(db, *one, path + ending, scale, read_here);
    EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr("stored image of row 5 is damaged"));
    EXPECT_FALSE(std::ifstream(path + ending).good());
  };
  stored.set_exr(*encode_exr(image));
  std::string png = *encode_png(image);
  png[png.size() / 2] = static_cast<char>(png[png.size() / 2] ^ 1);
  for (const std::string& bytes : {std::string(), std::string("png"), png, png.substr(0, 40)}) {
    stored.set_png(bytes);
    refused(".png", "");
  }
  stored.set_png(*encode_png(image));
  stored.set_exr(stored.exr().substr(0, stored.exr().size() - 20));
  refused(".exr", "");
  refused(".png", "0,2");
  EXPECT_TRUE(write_thumbnail(db, *one, path + ".png", "", read_here).ok());
  // More pixels than its sweep asked for: not decoded.
  stored.set_exr(*encode_exr({5, 1, {0, 1, 2, 3, 4}}));
  refused(".exr", "");
  std::remove((path + ".png").c_str());
}

TEST(Thumbnail, OnACommonScale) {
  FakeDatabase db = fake_database();
  const std::string path = ::testing::TempDir() + "irsig_scaled_test.png";
  const auto exr = [](float hottest) { return *encode_exr({2, 2, {0.0f, 1.0f, 2.0f, hottest}}); };
  // The hottest image of the same band counts, that of another band does not.
  const std::string band = db.signatures[4].band;
  std::size_t same = 0, other = 0;
  for (std::size_t i = 0; i < db.signatures.size(); ++i)
    if (i != 4) (db.signatures[i].band == band ? same : other) = i;
  db.thumbnails[db.signatures[4].signature_id].set_exr(exr(4));
  db.thumbnails[db.signatures[same].signature_id].set_exr(exr(10));
  db.thumbnails[db.signatures[other].signature_id].set_exr(exr(1000));
  const auto one = run_query(db, {.row = 5});
  ASSERT_TRUE(one.ok());
  allow_images(db);
  const auto written = [&](const std::string& scale) {
    EXPECT_TRUE(write_thumbnail(db, *one, path, scale, read_here).ok()) << scale;
    std::ifstream in(path);
    std::stringstream bytes;
    bytes << in.rdbuf();
    return bytes.str();
  };
  const RadianceImage image{2, 2, {0.0f, 1.0f, 2.0f, 4.0f}};
  EXPECT_EQ(written("common"), *encode_png(image, {0, 10}));
  EXPECT_EQ(written("1,3"), *encode_png(image, {1, 3}));
  EXPECT_NE(*encode_png(image, {1, 3}), *encode_png(image));
  EXPECT_EQ(*encode_png(image, {0, 4}), *encode_png(image));
  std::remove(path.c_str());
  for (const char* scale : {"3,1", "1", "a,b", "0,inf", "1,1", "mine"})
    EXPECT_THAT(std::string(write_thumbnail(db, *one, path, scale).message()),
                HasSubstr("expected common, or BLACK,WHITE"))
        << scale;
  EXPECT_THAT(std::string(write_thumbnail(db, *one, "a.exr", "common").message()),
              HasSubstr("without a scale"));
}

}  // namespace
}  // namespace irsig
