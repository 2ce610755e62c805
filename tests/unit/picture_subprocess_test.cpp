// Stored images are read by a process of its own: whatever they do to that, this one goes on.
#include "core/image/apart/picture_subprocess.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "core/image/image.h"
#include "tests/unit/test_folder.h"

namespace irsig {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string exr_of(std::vector<float> pixel, std::uint32_t width_px) {
  const auto height_px = static_cast<std::uint32_t>(pixel.size()) / width_px;
  return *encode_exr({width_px, height_px, std::move(pixel)});
}

TEST(PictureApart, LooksPaintsAndHandsOutPixels) {
  const RadianceImage image{3, 2, {0, 1, 2, 0, 4, 0}};
  std::vector<PictureTask> tasks(3);
  for (PictureTask& task : tasks) {
    task.exr = *encode_exr(image);
    task.most_px = 3;
  }
  tasks[1].paint = true;
  tasks[1].white_w_m2_sr = 8;
  tasks[2].pixels = true;
  const std::vector<float> filled = {0, 0.5f, 1, 0, 0.25f, 0};
  tasks[2].seen = PictureTask::Seen{2, 1, 5, filled};
  const auto answers = read_pictures_subprocess(picture_program(), tasks);
  ASSERT_TRUE(answers.ok()) << answers.status();
  ASSERT_EQ(answers->size(), 3U);
  const PictureAnswer& looked = (*answers)[0];
  EXPECT_EQ(looked.damage, "");
  EXPECT_EQ(looked.hottest_w_m2_sr, 4);
  EXPECT_EQ(looked.shown_px, 3U);
  EXPECT_EQ(looked.left_px, 1U);
  EXPECT_EQ(looked.box_width_px, 2U);
  EXPECT_EQ(looked.png, "");
  EXPECT_THAT(looked.pixel, IsEmpty());
  EXPECT_EQ((*answers)[1].png, *encode_png(image, {0, 8}));
  EXPECT_EQ((*answers)[2].width_px, 3U);
  EXPECT_EQ((*answers)[2].pixel, seen_from(image, {2, 1, 5, filled})->radiance_w_m2_sr);
}

// One image of 1.6 MB took 4.7 GB; one that is damaged is told apart from its neighbours.
TEST(PictureApart, WhatIsDamagedOrTooLargeIsItsOwnImage) {
  const std::string good = exr_of({1, 2, 3, 4}, 2);
  std::vector<PictureTask> tasks = {{.exr = good, .most_px = 2},
                                    {.exr = exr_of({1, 2, 3, 4, 5, 6}, 3), .most_px = 2},
                                    {.exr = "no image", .most_px = 2},
                                    {.exr = good, .most_px = 2}};
  const auto answers = read_pictures_subprocess(picture_program(), tasks);
  ASSERT_TRUE(answers.ok()) << answers.status();
  EXPECT_EQ((*answers)[0].hottest_w_m2_sr, 4);
  EXPECT_THAT((*answers)[1].damage, HasSubstr("states 3 x 2 pixels, expected sides of at most 2"));
  EXPECT_THAT((*answers)[2].damage, HasSubstr("image: "));
  EXPECT_EQ((*answers)[3].hottest_w_m2_sr, 4);
}

// Any other program in its place, as if the library had turned it into that.
class ReadByAnother : public ::testing::Test {
 protected:
  absl::StatusOr<std::vector<PictureAnswer>> read_by(const std::string& script,
                                                     const std::vector<PictureTask>& tasks) {
    const std::string path = folder_.file("picture");
    std::ofstream(path) << "#!/bin/sh\n" << script << "\n";
    ::chmod(path.c_str(), 0700);
    return read_pictures_subprocess(path, tasks);
  }
  TestFolder folder_;
};

TEST_F(ReadByAnother, AnImageThatEndsItIsFoundAndTheOthersAreRead) {
  const std::string good = exr_of({1, 2, 3, 4}, 2);
  std::vector<PictureTask> tasks(5, {.exr = good, .most_px = 2});
  tasks[3].exr = "deadly";
  const auto answers =
      read_by("f=$(mktemp); cat > $f; if grep -q deadly $f; then rm $f; kill -SEGV $$; fi\n" +
                  picture_program() + " $1 < $f; rm $f",
              tasks);
  ASSERT_TRUE(answers.ok()) << answers.status();
  ASSERT_EQ(answers->size(), 5U);
  for (const std::size_t i : {0U, 1U, 2U, 4U}) EXPECT_EQ((*answers)[i].hottest_w_m2_sr, 4) << i;
  EXPECT_THAT((*answers)[3].damage, HasSubstr("crashed on it (signal 11)"));
}

TEST_F(ReadByAnother, NoAnswerIsAnError) {
  const std::vector<PictureTask> tasks(2, {.exr = "x", .most_px = 2});
  const auto expect = [&](const std::string& script, const std::string& text) {
    const auto status = read_by(script, tasks).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInternal) << script;
    EXPECT_THAT(std::string(status.message()), HasSubstr(text)) << script;
  };
  expect("cat > /dev/null", "said nothing");
  expect("exec cat", "no complete answer");
  expect("cat > /dev/null; printf 'irsig answers 1\\n'", "another number of images");
  expect("cat > /dev/null; printf 'irsig answers 1\\nx'", "no complete answer");
  expect("kill -KILL $$", "killed by signal 9");
  EXPECT_THAT(std::string(read_pictures_subprocess(folder_.file("none"), tasks).status().message()),
              HasSubstr("it belongs beside the irsig executable"));
}

TEST(PictureExchange, ComesBackAsItWasAndIsRefusedWhereItIsCut) {
  const std::vector<PictureTask> tasks = {
      {.exr = std::string("\0\t\n\xff", 4), .most_px = 9, .white_w_m2_sr = 2.5f},
      {.exr = "", .most_px = 4096, .paint = true, .seen = PictureTask::Seen{1, 2, 3, {0.5f, 4}}}};
  const std::string sent = encode_tasks(tasks);
  const auto back = decode_tasks(sent);
  ASSERT_TRUE(back.ok());
  ASSERT_EQ(back->size(), 2U);
  EXPECT_EQ((*back)[0].exr, tasks[0].exr);
  EXPECT_EQ((*back)[0].white_w_m2_sr, 2.5f);
  EXPECT_FALSE((*back)[0].seen);
  EXPECT_THAT((*back)[1].seen->filled, ElementsAre(0.5f, 4));
  std::vector<PictureAnswer> answers(2);
  answers[0].damage = "a\tb\nc";
  answers[1].png = std::string("\0\n", 2);
  answers[1].width_px = answers[1].height_px = 1;
  answers[1].pixel = {7};
  const std::string said = encode_answers(answers);
  EXPECT_EQ((*decode_answers(said))[0].damage, "a\tb\nc");
  EXPECT_THAT((*decode_answers(said))[1].pixel, ElementsAre(7));
  EXPECT_EQ(decode_answers(encode_answers(absl::InternalError("no"))).status(),
            absl::InvalidArgumentError("no"));
  int whole = 0;  // where one is complete, the list may end
  for (std::size_t length = 0; length < said.size(); ++length) {
    const auto some = decode_answers(said.substr(0, length));
    whole += some.ok() ? 1 : 0;
    EXPECT_TRUE(some.ok() || absl::IsDataLoss(some.status())) << length;
  }
  EXPECT_EQ(whole, 2);
  answers[1].width_px = 2;
  EXPECT_TRUE(absl::IsDataLoss(decode_answers(encode_answers(answers)).status()));
}

}  // namespace
}  // namespace irsig
