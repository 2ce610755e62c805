// [[profile]] and [[published]]: defaults, and what they mean for jobs and their keys.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "jobs/keys/expand.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using ::testing::ElementsAre;

constexpr const char* kLine =
    "[[profile]]\nname = \"line\"\nfrom_m = [0, -3, 0]\nto_m = [0, 1, 3]\npoints = 6\n";
constexpr const char* kPublished =
    "[[published]]\nprofile = \"line\"\nreflections = 16\nsource_radiance_temperature_k = 306\n"
    "source = \"a paper\"\n";

std::string with(const std::string& profiles) {
  return text_of(std::filesystem::path(IRSIG_SOURCE_DIR) / "jobs/examples/disk.toml") + profiles;
}

schema::ResolvedSweep resolved_with(const std::string& profiles) {
  const auto sweep = resolved_text(with(profiles));
  EXPECT_TRUE(sweep.ok()) << sweep.status();
  return sweep.ok() ? *sweep : schema::ResolvedSweep{};
}

TEST(ResolveProfile, WritesOutDefaults) {
  const schema::ResolvedSweep sweep =
      resolved_with(std::string(kLine) + "reflections = [0, 16]\n" + kPublished);
  ASSERT_EQ(sweep.sweep().profile_size(), 1);
  const schema::Profile& line = sweep.sweep().profile(0);
  EXPECT_EQ(line.footprint_width_m(), 1);  // 5 m in 5 steps
  EXPECT_EQ(line.footprint_height_m(), 1);
  EXPECT_EQ(line.source_radiance_temperature_stderr_k(), 0.05);
  EXPECT_FALSE(line.has_samples());
  const schema::Published& published = sweep.sweep().published(0);
  EXPECT_EQ(published.point_index(), 0U);
  EXPECT_EQ(published.relation(), "equal");
  EXPECT_EQ(published.remark(), "");
}

TEST(ResolveProfile, FollowsTheSweepsReflections) {
  const schema::ResolvedSweep sweep = resolved_with(kLine);
  EXPECT_THAT(sweep.sweep().profile(0).reflections(),
              ElementsAre(sweep.sweep().transport().max_reflections()));
}

TEST(ResolveProfile, DeterminesTheJobButWhatIsPublishedDoesNot) {
  const auto key = [](const std::string& profiles) {
    return expand_jobs(resolved_with(profiles), 1).at(0).job_key();
  };
  const std::string line = std::string(kLine) + "reflections = [0, 16]\n";
  EXPECT_NE(key(line), key(""));
  EXPECT_NE(key(line), key(kLine));
  EXPECT_NE(key(line), key(line + "footprint_width_m = 0.5\n"));
  EXPECT_NE(key(line), key(line + "samples = 1000\n"));
  EXPECT_EQ(key(line), key(line + kPublished));
}

}  // namespace
}  // namespace irsig
