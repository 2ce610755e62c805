// Costs and predictions are kept beside the sweep, and are no part of its content.

#include "tests/unit/store_fixture.h"

namespace irsig {
namespace {

StoredPrediction some_prediction(const std::string& sweep_sha256) {
  StoredPrediction p;
  p.sweep_sha256 = sweep_sha256;
  p.made_unix_s = 1.75e9;
  p.determinism_class = "some class";
  p.workers = 3;
  p.pilot_viewpoints = 5;
  p.pilot_cpu_s = 0.125;
  p.jobs = 4;
  p.cpu_s = 2.5;
  p.wall_s = 1.5;
  p.job_cpu_quartile1_s = 0.25;
  p.job_cpu_median_s = 0.5;
  p.job_cpu_quartile3_s = 0.75;
  p.database_bytes = 123456;
  return p;
}

class StoreCost : public ::testing::Test {
 protected:
  absl::Status store(const StoredPrediction& prediction) {
    auto writer = StoreWriter::open(path_);
    if (!writer.ok()) return writer.status();
    if (auto status = (*writer)->begin(); !status.ok()) return status;
    if (auto status = (*writer)->store_prediction(prediction); !status.ok()) return status;
    if (auto status = (*writer)->commit(); !status.ok()) return status;
    return (*writer)->finish();
  }
  absl::Status compute(const schema::ResolvedSweep& sweep) {
    auto writer = StoreWriter::open(path_);
    if (!writer.ok()) return writer.status();
    if (auto added = submit(**writer, sweep, "sweep-a"); !added.ok()) return added.status();
    if (auto done = complete_jobs(**writer, sweep); !done.ok()) return done.status();
    return (*writer)->finish();
  }
  std::unique_ptr<StoreReader> reader() { return StoreReader::open(path_).value(); }

  TestFolder folder_;
  std::string path_ = folder_.file("a.sigdb");
};

TEST_F(StoreCost, APredictionComesBackAndMayComeBeforeItsSweep) {
  ASSERT_OK(store(some_prediction("sweep-a")));
  ASSERT_OK(compute(make_sweep({})));
  const auto p = reader()->prediction("sweep-a").value();
  ASSERT_TRUE(p.has_value());
  EXPECT_EQ(p->sweep_sha256, "sweep-a");
  EXPECT_EQ(p->made_unix_s, 1.75e9);
  EXPECT_EQ(p->determinism_class, "some class");
  EXPECT_EQ(p->workers, 3u);
  EXPECT_EQ(p->pilot_viewpoints, 5u);
  EXPECT_EQ(p->pilot_cpu_s, 0.125);
  EXPECT_EQ(p->jobs, 4u);
  EXPECT_EQ(p->cpu_s, 2.5);
  EXPECT_EQ(p->wall_s, 1.5);
  EXPECT_EQ(p->job_cpu_quartile1_s, 0.25);
  EXPECT_EQ(p->job_cpu_median_s, 0.5);
  EXPECT_EQ(p->job_cpu_quartile3_s, 0.75);
  EXPECT_EQ(p->database_bytes, 123456u);
  EXPECT_FALSE(reader()->prediction("sweep-b").value().has_value());
}

TEST_F(StoreCost, AnotherPredictionReplacesTheFirst) {
  ASSERT_OK(store(some_prediction("sweep-a")));
  StoredPrediction later = some_prediction("sweep-a");
  later.cpu_s = 7;
  ASSERT_OK(store(later));
  EXPECT_EQ(reader()->prediction("sweep-a").value()->cpu_s, 7);
}

TEST_F(StoreCost, WhatMakesNoSenseIsRefused) {
  StoredPrediction wrong = some_prediction("sweep-a");
  wrong.job_cpu_median_s = 0.125;  // below the first quartile
  EXPECT_FALSE(store(wrong).ok());
  StoredPrediction negative = some_prediction("sweep-a");
  negative.cpu_s = -1;
  EXPECT_FALSE(store(negative).ok());
  auto writer = StoreWriter::open(path_).value();
  EXPECT_TRUE(absl::IsFailedPrecondition(writer->store_prediction(some_prediction("sweep-a"))));
}

TEST_F(StoreCost, APredictionIsNoPartOfTheDigest) {
  ASSERT_OK(compute(make_sweep({})));
  const std::string before = reader()->digest().value();
  ASSERT_OK(store(some_prediction("sweep-a")));
  EXPECT_EQ(reader()->digest().value(), before);
}

TEST_F(StoreCost, WhatDoneJobsTook) {
  const schema::ResolvedSweep sweep = make_sweep({});
  ASSERT_OK(compute(sweep));
  const auto jobs = reader()->job_costs("ship").value();
  ASSERT_EQ(jobs.size(), 4u);
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const schema::JobResult result = make_result(sweep, make_jobs(sweep, "sweep-a")[i]);
    EXPECT_EQ(jobs[i].job_index, i);
    EXPECT_EQ(jobs[i].viewpoint_index, i);
    EXPECT_EQ(jobs[i].cpu_s, result.seconds());
    EXPECT_EQ(jobs[i].samples, result.samples());
    EXPECT_EQ(jobs[i].rays, result.rays());
    EXPECT_EQ(jobs[i].target_paths, result.target_paths());
    EXPECT_EQ(jobs[i].guarded_backface_hits, result.guarded_backface_hits());
    EXPECT_EQ(jobs[i].guarded_negative, result.guarded_negative());
    EXPECT_FALSE(jobs[i].worker_name.empty());
  }
  EXPECT_TRUE(reader()->job_costs("no such sweep").value().empty());
}

TEST_F(StoreCost, TheSizeIsThatOfTheFile) {
  ASSERT_OK(compute(make_sweep({})));
  EXPECT_EQ(reader()->bytes().value(), std::filesystem::file_size(path_));
}

}  // namespace
}  // namespace irsig
