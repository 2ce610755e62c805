// [imager] of a sweep: what is refused, with its place, and that no job depends on it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "absl/strings/str_replace.h"
#include "core/imager/imager.h"
#include "jobs/check_resolved.h"
#include "jobs/keys/expand.h"
#include "messages/imager/imager_from_message.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

constexpr const char* kImagerTables = R"(
[imager]
name = "test"
[imager.optics]
aperture_m = 0.0125
f_number = 2
[imager.detector]
pitch_m = 15e-6
netd_k = 0.025
[imager.counts]
bits = 14
black_k = 250
white_k = 400
)";

using Changes = std::vector<std::pair<std::string, std::string>>;

// The smallest sweep of the documentation with these tables; places count from its last line.
std::string imager_sweep(const std::string& tables) {
  const std::string page =
      text_of(std::filesystem::path(IRSIG_SOURCE_DIR) / "docs/reference/sweep-file.md");
  const std::size_t first = page.find("```toml\n") + 8;
  return page.substr(first, page.find("```\n", first) - first) + tables;
}

std::string imager_refusal(const Changes& changes, const std::string& more = "") {
  const std::string text = imager_sweep(absl::StrReplaceAll(kImagerTables, changes) + more);
  const auto sweep = resolved_text(text);
  return sweep.ok() ? "" : std::string(sweep.status().message());
}

// The line of the text in the sweep's file.
std::string place_in_sweep(const std::string& text, const std::string& line) {
  const std::string before = text.substr(0, text.find("\n" + line) + 1);
  return "s.toml:" + std::to_string(1 + std::count(before.begin(), before.end(), '\n')) + ":";
}

TEST(SweepImager, IsStoredAsItIsStated) {
  const auto sweep = resolved_text(imager_sweep(kImagerTables));
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  const auto imager = imager_from_message(sweep->sweep().imager());
  ASSERT_TRUE(imager.ok()) << imager.status();
  EXPECT_DOUBLE_EQ(imager->ifov_rad(), 15e-6 / 0.025);
  EXPECT_EQ(imager->bits, 14U);
  EXPECT_EQ(imager->margin_px, 4U);
  EXPECT_EQ(std::get<CountsOfTemperatures>(imager->gain).white_k, 400);
  // The coordinator's check passes the sweep.
  EXPECT_EQ(check_resolved(*sweep), absl::OkStatus());
  // The pilot's sweep passes it, too.
  schema::ResolvedSweep pilot = *sweep;
  pilot.mutable_sweep()->mutable_output()->set_thumbnail_px(0);
  EXPECT_EQ(check_resolved(pilot), absl::OkStatus());
}

TEST(SweepImager, NoJobDependsOnIt) {
  const auto without = resolved_text(imager_sweep(""));
  const auto with = resolved_text(imager_sweep(kImagerTables));
  const auto other =
      resolved_text(imager_sweep(absl::StrReplaceAll(kImagerTables, {{"0.025", "0.05"}})));
  ASSERT_TRUE(without.ok() && with.ok() && other.ok());
  const auto jobs = expand_jobs(*without, 1), same = expand_jobs(*with, 1),
             again = expand_jobs(*other, 1);
  ASSERT_EQ(jobs.size(), same.size());
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    EXPECT_EQ(jobs[i].job_key(), same[i].job_key());
    EXPECT_EQ(jobs[i].job_key(), again[i].job_key());
  }
  // The sweep itself is another one.
  EXPECT_NE(sha256_hex(canonical_encoding(*with)), sha256_hex(canonical_encoding(*other)));
}

TEST(SweepImager, IsRefusedWithItsPlace) {
  const auto refused = [](const Changes& changes, const std::string& line,
                          const std::string& what) {
    const std::string said = imager_refusal(changes);
    EXPECT_THAT(said, HasSubstr(what));
    const std::string text = imager_sweep(absl::StrReplaceAll(kImagerTables, changes));
    EXPECT_THAT(said, HasSubstr(place_in_sweep(text, line))) << what;
  };
  refused({{"bits = 14", "bits = 12"}}, "bits = 12", "imager.counts.bits = 12, expected 8, 14");
  refused({{"f_number = 2\n", ""}}, "[imager.optics]", "imager.optics.f_number is missing");
  refused({{"netd_k = 0.025", "netd_k = -1"}}, "netd_k = -1", "imager.detector.netd_k = -1");
  refused({{"white_k = 400", "white_k = 200"}}, "white_k = 200",
          "imager.counts.white_k = 200, expected more than black_k = 250");
  refused({{"black_k = 250\n", ""}}, "[imager.counts]", "imager.counts.black_k is missing");
  refused({{"white_k = 400", "white_k = 400\noffset_counts = 1"}}, "[imager.counts]",
          "imager.counts states two gains");
  // A band in which blackbodies of the gain have no radiance.
  refused({{"black_k = 250", "black_k = 0"}, {"white_k = 400", "white_k = 1"}}, "[imager.counts]",
          "gives a finite gain");
  EXPECT_THAT(imager_refusal({{"name = \"test\"", "name = \"=1\""}}),
              HasSubstr("imager.name = \"=1\": spreadsheets run"));
  EXPECT_THAT(imager_refusal({{"netd_k", "netd"}}), HasSubstr("netd_k"));
  EXPECT_THAT(imager_refusal({}, "[output]\nthumbnail_px = 0\n"),
              HasSubstr("imager has no image to record"));
}

TEST(SweepImager, PixelsOfACameraSuffice) {
  const auto camera = [](int pixels) {
    return imager_refusal({}, "[image]\nkind = \"camera\"\nfield_of_view_deg = 1\npixels = [" +
                                  std::to_string(pixels) + ", 40]\n");
  };
  // 1 deg is 29.09 pixels of 600 urad: 58.2 stored ones are needed.
  EXPECT_THAT(camera(58), HasSubstr("thumbnail_px = 59 or more"));
  EXPECT_EQ(camera(59), "");
}

// Numbers of a damaged database are refused before anything is computed with them.
TEST(SweepImager, NumbersThatNoCameraHasAreRefused) {
  const auto sweep = resolved_text(imager_sweep(kImagerTables));
  ASSERT_TRUE(sweep.ok());
  const auto refused = [&](auto&& change) {
    schema::ImagerFile damaged = sweep->sweep().imager();
    change(damaged);
    EXPECT_TRUE(absl::IsInvalidArgument(imager_from_message(damaged).status()));
  };
  refused([](auto& i) { i.mutable_optics()->set_f_number(0); });
  refused([](auto& i) { i.mutable_optics()->set_aperture_m(std::nan("")); });
  refused([](auto& i) { i.mutable_detector()->set_pitch_m(-1); });
  refused([](auto& i) { i.mutable_detector()->set_margin_px(1u << 31); });
  refused([](auto& i) { i.mutable_detector()->set_netd_k(INFINITY); });
  refused([](auto& i) { i.mutable_counts()->set_bits(32); });
  refused([](auto& i) { i.clear_counts(); });
  refused([](auto& i) { i.clear_optics(); });
  refused([](auto& i) { i.mutable_counts()->set_white_k(250); });
}

}  // namespace
}  // namespace irsig
