// Shards: parts of a sweep whose jobs are those of the whole.
#include "jobs/shard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "jobs/check_resolved.h"
#include "jobs/keys/expand.h"
#include "schema/shard.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

schema::ResolvedSweep shard_example(const char* name) {
  const auto sweep =
      resolved_file(std::filesystem::path(IRSIG_SOURCE_DIR) / "jobs/examples" / name);
  EXPECT_TRUE(sweep.ok()) << sweep.status();
  return *sweep;
}

std::map<std::string, std::string> jobs_by_key(const schema::ResolvedSweep& sweep) {
  std::map<std::string, std::string> out;
  for (schema::JobSpec& job : expand_jobs(sweep, 1)) {
    EXPECT_EQ(job.sweep_sha256(), sha256_hex(canonical_encoding(sweep)));
    job.clear_sweep_sha256();
    EXPECT_TRUE(out.emplace(job.job_key(), job.SerializeAsString()).second);
  }
  return out;
}

TEST(Shard, TogetherHaveTheJobsOfTheWholeEachOnce) {
  const schema::ResolvedSweep whole = shard_example("quickstart.toml");
  const auto all = jobs_by_key(whole);
  for (const int of : {2, 5, 24}) {
    std::map<std::string, std::string> together;
    for (int k = 1; k <= of; ++k) {
      schema::ResolvedSweep sweep = whole;
      ASSERT_TRUE(take_shard(absl::StrCat(k, "/", of), sweep).ok());
      EXPECT_EQ(sweep.shard().sweep_sha256(), sha256_hex(canonical_encoding(whole)));
      EXPECT_NE(sha256_hex(canonical_encoding(sweep)), sweep.shard().sweep_sha256());
      EXPECT_TRUE(check_resolved(sweep).ok()) << check_resolved(sweep);
      const auto jobs = jobs_by_key(sweep);
      EXPECT_EQ(jobs.size(), shard_size(sweep));
      EXPECT_EQ(jobs.size(), job_count(sweep));
      for (std::uint64_t i = 0; i < shard_size(sweep); ++i)
        EXPECT_TRUE(in_shard(sweep, shard_viewpoint(sweep, i)));
      for (const auto& job : jobs) EXPECT_TRUE(together.insert(job).second);
    }
    EXPECT_EQ(together, all);
  }
}

TEST(Shard, EachNeedsTheTemperaturesOfTheWhole) {
  const schema::ResolvedSweep whole = shard_example("frigate_day.toml");
  ASSERT_GT(whole.heat_size(), 0);
  schema::ResolvedSweep sweep = whole;
  ASSERT_TRUE(take_shard("2/2", sweep).ok());
  const auto all = expand_jobs(whole, 1), jobs = expand_jobs(sweep, 1);
  for (int run = 0; run < whole.heat_size(); ++run)
    EXPECT_EQ(jobs[static_cast<std::size_t>(run)].job_key(),
              all[static_cast<std::size_t>(run)].job_key());
}

TEST(Shard, OneOfOneIsTheWhole) {
  schema::ResolvedSweep sweep = shard_example("quickstart.toml");
  ASSERT_TRUE(take_shard("1/1", sweep).ok());
  EXPECT_FALSE(sweep.has_shard());
}

TEST(Shard, RefusesWhatIsNone) {
  for (const char* text : {"0/3", "4/3", "a/b", "1", "", "/", "1/", "/3", "1/3/5", "-1/3", "+1/3",
                           " 1/3", "1/3 ", "1.0/3", "1/4294967296", "0/0"}) {
    schema::ResolvedSweep sweep = shard_example("quickstart.toml");
    const absl::Status status = take_shard(text, sweep);
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << text;
    EXPECT_THAT(std::string(status.message()), HasSubstr("expected K/N")) << text;
    EXPECT_FALSE(sweep.has_shard());
  }
  schema::ResolvedSweep sweep = shard_example("quickstart.toml");
  EXPECT_THAT(std::string(take_shard("1/25", sweep).message()), HasSubstr("has 24 viewpoints"));
  sweep.mutable_sweep()->mutable_accuracy()->clear_relative_error();
  sweep.mutable_sweep()->mutable_accuracy()->set_time_budget_s(10);
  EXPECT_THAT(std::string(take_shard("1/3", sweep).message()), HasSubstr("time_budget_s"));
}

TEST(Shard, IsCheckedWhereItIsSubmitted) {
  schema::ResolvedSweep good = shard_example("quickstart.toml");
  ASSERT_TRUE(take_shard("2/3", good).ok());
  const auto error = [](const schema::ResolvedSweep& sweep) {
    return std::string(check_resolved(sweep).message());
  };
  for (const auto& [number, of] : {std::pair{0, 3}, {4, 3}, {1, 1}, {0, 0}, {1, 25}}) {
    schema::ResolvedSweep sweep = good;
    sweep.mutable_shard()->set_number(static_cast<std::uint32_t>(number));
    sweep.mutable_shard()->set_of(static_cast<std::uint32_t>(of));
    EXPECT_THAT(error(sweep), HasSubstr("expected one of 2 or more")) << number << "/" << of;
  }
  schema::ResolvedSweep sweep = good;
  sweep.mutable_sweep()->set_seed(sweep.sweep().seed() + 1);
  EXPECT_THAT(error(sweep), HasSubstr("shard.sweep_sha256"));
}

// A stored sweep may have such numbers.
TEST(Shard, OfAnImpossibleNumberIsNone) {
  for (const auto& [number, of] : {std::pair{0, 0}, {1, 0}, {0, 3}, {4, 3}}) {
    schema::ResolvedSweep sweep = shard_example("quickstart.toml");
    sweep.mutable_shard()->set_number(static_cast<std::uint32_t>(number));
    sweep.mutable_shard()->set_of(static_cast<std::uint32_t>(of));
    EXPECT_EQ(shard_size(sweep), 24U);
    EXPECT_EQ(shard_viewpoint(sweep, 7), 7U);
    EXPECT_TRUE(in_shard(sweep, 7));
  }
}

TEST(Shard, TakesNoOthersPlace) {
  const schema::ResolvedSweep whole = shard_example("quickstart.toml");
  schema::ResolvedSweep first = whole, second = whole, half = whole, slice = whole;
  ASSERT_TRUE(take_shard("1/3", first).ok());
  ASSERT_TRUE(take_shard("2/3", second).ok());
  ASSERT_TRUE(take_shard("1/2", half).ok());
  slice.add_slice();
  EXPECT_TRUE(check_may_replace(whole, whole).ok());
  EXPECT_TRUE(check_may_replace(first, first).ok());
  EXPECT_TRUE(check_may_replace(first, whole).ok()) << "the whole goes on with a shard";
  for (const auto& stored : {second, half})
    EXPECT_THAT(std::string(check_may_replace(stored, first).message()), HasSubstr("holds shard"));
  EXPECT_THAT(std::string(check_may_replace(whole, first).message()), HasSubstr("holds all of"));
  EXPECT_THAT(std::string(check_may_replace(slice, first).message()), HasSubstr("holds a slice"));
}

}  // namespace
}  // namespace irsig
