// Leases, fencing tokens, failures, quarantine, cancellation, binding to a determinism class.

#include <random>

#include "tests/unit/store_fixture.h"

namespace irsig {
namespace {

class StoreQueue : public ::testing::Test {
 protected:
  void SetUp() override {
    open();
    ASSERT_OK(submit(*writer_, sweep_, "sweep-a").status());
    ASSERT_OK(writer_->begin());
  }
  void open() {
    auto writer = StoreWriter::open(path_);
    ASSERT_OK(writer.status());
    writer_ = *std::move(writer);
  }
  QueuedJob lease(const std::string& worker_id = "w") {
    const auto job = writer_->lease_next(worker_id, 100);
    EXPECT_TRUE(job.ok()) << job.status();
    EXPECT_TRUE(job->has_value());
    return **job;
  }
  SweepProgress progress() { return writer_->progress().value().front(); }

  TestFolder folder_;
  std::string path_ = folder_.file("a.sigdb");
  schema::ResolvedSweep sweep_ = make_sweep({});
  std::unique_ptr<StoreWriter> writer_;
};

TEST_F(StoreQueue, LeasesInSweepOrderUnderIncreasingTokens) {
  std::uint64_t last = 0;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const QueuedJob job = lease();
    EXPECT_EQ(job.spec.view().viewpoint_index(), i);
    EXPECT_EQ(job.spec.sweep_sha256(), "sweep-a");
    EXPECT_EQ(job.spec.job_key(), make_jobs(sweep_, "")[i].job_key());
    EXPECT_EQ(job.spec.view().condition_index_size(), 2);
    EXPECT_EQ(job.spec.view().band_index(1), 1U);
    EXPECT_EQ(job.state, JobState::kLeased);
    EXPECT_GT(job.fencing_token, last);
    last = job.fencing_token;
  }
  EXPECT_FALSE(writer_->lease_next("w", 0).value().has_value());
  EXPECT_EQ(progress().leased, 4U);
}

TEST_F(StoreQueue, TokensKeepIncreasingAfterARestart) {
  const QueuedJob before = lease();
  ASSERT_OK(writer_->commit());
  writer_.reset();
  open();
  ASSERT_OK(writer_->begin());
  ASSERT_OK(writer_->release_all());
  EXPECT_EQ(progress().waiting, 4U);
  const QueuedJob after = lease();
  EXPECT_EQ(after.spec.job_key(), before.spec.job_key());
  EXPECT_GT(after.fencing_token, before.fencing_token);
  EXPECT_TRUE(absl::IsFailedPrecondition(
      writer_->complete(before.fencing_token, make_result(sweep_, before.spec), "late")));
  ASSERT_OK(writer_->complete(after.fencing_token, make_result(sweep_, after.spec), "current"));
  EXPECT_EQ(progress().done, 1U);
}

TEST_F(StoreQueue, ALateResultIsRefused) {
  const QueuedJob job = lease();
  ASSERT_OK(writer_->release(job.fencing_token, "silent"));
  const auto result = make_result(sweep_, job.spec);
  EXPECT_TRUE(absl::IsFailedPrecondition(writer_->complete(job.fencing_token, result, "late")));
  EXPECT_TRUE(absl::IsFailedPrecondition(writer_->release(job.fencing_token, "again")));
  EXPECT_TRUE(absl::IsFailedPrecondition(writer_->fail(job.fencing_token, "late", "x")));
  const QueuedJob again = lease();
  ASSERT_OK(writer_->complete(again.fencing_token, result, "current"));
  EXPECT_TRUE(absl::IsFailedPrecondition(writer_->complete(again.fencing_token, result, "twice")));
  EXPECT_TRUE(absl::IsFailedPrecondition(writer_->complete(4711, result, "never leased")));
}

TEST_F(StoreQueue, FailuresOnThreeWorkersQuarantine) {
  const QueuedJob first = lease();
  ASSERT_OK(writer_->fail(first.fencing_token, "host:1", "no memory"));
  // It went to the back of the queue, so that the others come first.
  EXPECT_EQ(lease().spec.view().viewpoint_index(), 1U);
  EXPECT_EQ(lease().spec.view().viewpoint_index(), 2U);
  EXPECT_EQ(lease().spec.view().viewpoint_index(), 3U);
  const QueuedJob second = lease();
  EXPECT_EQ(second.spec.view().viewpoint_index(), 0U);
  EXPECT_EQ(second.failures, 1U);
  ASSERT_OK(writer_->fail(second.fencing_token, "host:1", "no memory again"));
  const QueuedJob third = lease();
  EXPECT_EQ(third.failures, 1U) << "the same worker counts once";
  ASSERT_OK(writer_->fail(third.fencing_token, "host:2", "no memory"));
  EXPECT_EQ(progress().quarantined, 0U);
  ASSERT_OK(writer_->fail(lease().fencing_token, "host:3", "out of stack"));
  EXPECT_EQ(progress().quarantined, 1U);
  EXPECT_EQ(progress().failures, std::vector<std::string>{"job 0 on host:3: out of stack"});
  EXPECT_FALSE(writer_->lease_next("w", 0).value().has_value());

  // Submitted again, it gets a new chance, with a clean slate.
  ASSERT_OK(writer_->commit());
  const auto added = submit(*writer_, sweep_, "sweep-a");
  ASSERT_OK(added.status());
  EXPECT_EQ(added->to_compute, 4U);
  ASSERT_OK(writer_->begin());
  const QueuedJob fresh = lease();
  EXPECT_EQ(fresh.spec.view().viewpoint_index(), 0U);
  EXPECT_EQ(fresh.failures, 0U);
  ASSERT_OK(writer_->fail(fresh.fencing_token, "host:4", "x"));
  EXPECT_EQ(progress().quarantined, 0U);
}

TEST_F(StoreQueue, OneWorkerAloneCannotFailForever) {
  int attempts = 0;
  for (; progress().quarantined < 4 && attempts < 100; ++attempts) {
    ASSERT_OK(writer_->fail(lease().fencing_token, "host:1", "x"));
  }
  EXPECT_EQ(attempts, 4 * 6);
}

TEST_F(StoreQueue, CancelEndsWhatIsNotDone) {
  const QueuedJob done = lease();
  ASSERT_OK(writer_->complete(done.fencing_token, make_result(sweep_, done.spec), "w"));
  const QueuedJob running = lease();
  EXPECT_TRUE(absl::IsNotFound(writer_->cancel("unknown").status()));
  const auto cancelled = writer_->cancel("sweep-a");
  ASSERT_OK(cancelled.status());
  EXPECT_EQ(*cancelled, 3U);
  EXPECT_EQ(progress().cancelled, 3U);
  EXPECT_EQ(progress().done, 1U);
  EXPECT_TRUE(absl::IsFailedPrecondition(
      writer_->complete(running.fencing_token, make_result(sweep_, running.spec), "w")));
  EXPECT_FALSE(writer_->lease_next("w", 0).value().has_value());
  ASSERT_OK(writer_->commit());
  EXPECT_EQ(submit(*writer_, sweep_, "sweep-a")->to_compute, 3U);
}

TEST_F(StoreQueue, ProgressSumsRaysAndFindsTheWorstError) {
  std::uint64_t rays = 0;
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    const QueuedJob job = lease();
    const auto result = make_result(sweep_, job.spec);
    rays += result.rays();
    for (const auto& row : result.view().row()) {
      worst = std::max(worst, row.numerical_error_w_sr() / row.intensity_w_sr().value());
    }
    ASSERT_OK(writer_->complete(job.fencing_token, result, "w"));
  }
  EXPECT_EQ(progress().rays, rays);
  EXPECT_EQ(progress().worst_relative_error, worst);
  EXPECT_EQ(progress().jobs, 4U);
  EXPECT_EQ(progress().waiting, 1U);
}

TEST_F(StoreQueue, AnUnfinishedSweepKeepsItsDeterminismClass) {
  EXPECT_EQ(writer_->determinism_class().value(), "");
  ASSERT_OK(writer_->bind_determinism_class("avx2"));
  EXPECT_EQ(writer_->determinism_class().value(), "avx2");
  ASSERT_OK(writer_->bind_determinism_class("avx2"));
  EXPECT_TRUE(absl::IsFailedPrecondition(writer_->bind_determinism_class("avx512")));
  ASSERT_OK(writer_->commit());
  ASSERT_OK(complete_jobs(*writer_, sweep_).status());
  EXPECT_EQ(writer_->determinism_class().value(), "") << "nothing is unfinished";
  // One more viewpoint of the same sweep must come from the class of the others.
  SweepShape shape;
  shape.aspects.emplace_back(45, 45);
  ASSERT_OK(submit(*writer_, make_sweep(shape), "sweep-b").status());
  EXPECT_EQ(writer_->determinism_class().value(), "avx2");
}

// Jobs 2 and 3 need job 0, job 3 also job 2.
class StoreNeeds : public StoreQueue {
 protected:
  void SetUp() override {
    open();
    submit_with_needs();
    ASSERT_OK(writer_->begin());
  }
  void submit_with_needs() {
    auto jobs = make_jobs(sweep_, "sweep-a");
    jobs[2].add_needs(jobs[0].job_key());
    jobs[3].add_needs(jobs[0].job_key());
    jobs[3].add_needs(jobs[2].job_key());
    ASSERT_OK(writer_->begin());
    ASSERT_OK(writer_->add_sweep(sweep_, "sweep-a", jobs, {}).status());
    ASSERT_OK(writer_->commit());
  }
  std::optional<std::uint32_t> next() {
    const auto job = writer_->lease_next("w", 100).value();
    if (!job) return std::nullopt;
    leased_[job->spec.view().viewpoint_index()] = *job;
    return job->spec.view().viewpoint_index();
  }
  void complete(std::uint32_t view) {
    const QueuedJob& job = leased_[view];
    ASSERT_OK(writer_->complete(job.fencing_token, make_result(sweep_, job.spec), "w"));
  }
  std::map<std::uint32_t, QueuedJob> leased_;
};

TEST_F(StoreNeeds, AJobWaitsForThoseThatItNeeds) {
  EXPECT_EQ(next(), 0U);
  EXPECT_EQ(next(), 1U);
  EXPECT_EQ(next(), std::nullopt);
  EXPECT_EQ(progress().waiting, 2U);
  complete(1);
  EXPECT_EQ(next(), std::nullopt) << "nobody needs job 1";
  complete(0);
  EXPECT_EQ(next(), 2U);
  EXPECT_EQ(leased_[2].spec.needs_size(), 1);
  EXPECT_EQ(leased_[2].spec.needs(0), leased_[0].spec.job_key());
  EXPECT_EQ(next(), std::nullopt) << "job 3 needs job 2, too";
  ASSERT_OK(writer_->release(leased_[2].fencing_token, "lost"));
  EXPECT_EQ(next(), 2U);
  complete(2);
  EXPECT_EQ(next(), 3U);
  complete(3);
  EXPECT_EQ(progress().done, 4U);
}

TEST_F(StoreNeeds, WhatNeedsAJobThatWasGivenUpIsGivenUp) {
  for (const char* worker : {"a", "b", "c"}) {
    QueuedJob job = lease();
    if (job.spec.view().viewpoint_index() == 1) {
      leased_[1] = job;
      job = lease();
    }
    ASSERT_EQ(job.spec.view().viewpoint_index(), 0U);
    ASSERT_OK(writer_->fail(job.fencing_token, worker, "no memory"));
  }
  EXPECT_EQ(progress().quarantined, 3U);
  EXPECT_EQ(progress().waiting, 0U) << "a farm would wait for ever";
  EXPECT_EQ(progress().failures,
            (std::vector<std::string>{"job 0 on c: no memory",
                                      "2 jobs (2 to 3): need job 0, which was given up"}));
  complete(1);
  ASSERT_OK(writer_->commit());
  // Submitted again, all of them wait again, in their order.
  submit_with_needs();
  ASSERT_OK(writer_->begin());
  EXPECT_EQ(progress().waiting, 3U);
  EXPECT_EQ(next(), 0U);
  EXPECT_EQ(next(), std::nullopt);
  complete(0);
  EXPECT_EQ(next(), 2U);
}

TEST_F(StoreNeeds, NeedsOutliveARestartAndAreThoseOfTheLastSubmission) {
  EXPECT_EQ(next(), 0U);
  ASSERT_OK(writer_->commit());
  writer_.reset();
  open();
  ASSERT_OK(writer_->begin());
  ASSERT_OK(writer_->release_all());
  EXPECT_EQ(next(), 0U);
  EXPECT_EQ(next(), 1U);
  EXPECT_EQ(next(), std::nullopt);
  complete(0);
  ASSERT_OK(writer_->commit());
  submit_with_needs();  // job 0 is done already
  ASSERT_OK(writer_->begin());
  EXPECT_EQ(next(), 2U);
  ASSERT_OK(writer_->commit());
  ASSERT_OK(submit(*writer_, sweep_, "sweep-a").status());  // without needs
  ASSERT_OK(writer_->begin());
  EXPECT_EQ(next(), 3U);
}

// The counters are carried along with each change; a reader counts every job.
TEST_F(StoreQueue, CountersAreWhatCountingGives) {
  const schema::ResolvedSweep heated = with_heat(make_sweep({.name = "heated"}));
  const auto same = [&] {
    auto reader = StoreReader::open(path_);
    ASSERT_OK(reader.status());
    const auto counted = (*reader)->progress().value(), kept = writer_->progress().value();
    ASSERT_EQ(kept.size(), counted.size());
    for (std::size_t i = 0; i < kept.size(); ++i) {
      const SweepProgress &a = kept[i], &b = counted[i];
      EXPECT_EQ(a.name, b.name);
      EXPECT_EQ(a.sweep_sha256, b.sweep_sha256);
      EXPECT_EQ(std::vector({a.jobs, a.waiting, a.leased, a.done, a.quarantined, a.cancelled,
                             a.rays, a.heat_jobs, a.heat_done}),
                std::vector({b.jobs, b.waiting, b.leased, b.done, b.quarantined, b.cancelled,
                             b.rays, b.heat_jobs, b.heat_done}));
      EXPECT_EQ(a.worst_relative_error, b.worst_relative_error);
      EXPECT_EQ(a.failures, b.failures);
    }
  };
  ASSERT_OK(writer_->commit());
  std::mt19937 random(5);
  std::vector<QueuedJob> held;
  for (int step = 0; step < 300 && !testing::Test::HasFailure(); ++step) {
    ASSERT_OK(writer_->begin());
    switch (random() % 12) {
      case 0:
      case 1:
      case 2:
      case 3: {
        const auto job = writer_->lease_next("w", 0);
        ASSERT_OK(job.status());
        if (job->has_value()) held.push_back(**job);
        break;
      }
      case 4:
        if (step > 20 && step % 5 == 0) (void)writer_->cancel(random() % 2 ? "sweep-a" : "sweep-h");
        break;
      case 5:
        ASSERT_OK(
            writer_->add_sweep(heated, "sweep-h", make_heat_jobs(heated, "sweep-h"), {}).status());
        break;
      case 6:
        if (step % 7 == 0) ASSERT_OK(writer_->release_all());
        break;
      case 7: {  // undone
        ASSERT_OK(writer_->begin_request());
        (void)writer_->lease_next("w", 0);
        ASSERT_OK(writer_->undo_request());
        break;
      }
      default: {
        if (held.empty()) break;
        const QueuedJob job = held.back();
        held.pop_back();
        const int what = static_cast<int>(random() % 3);
        const auto& of = job.spec.sweep_sha256() == "sweep-h" ? heated : sweep_;
        if (what == 0) {
          (void)writer_->release(job.fencing_token, "why");
        } else if (what == 1) {
          (void)writer_->fail(job.fencing_token, absl::StrCat("host:", random() % 5), "oh");
        } else {
          (void)writer_->complete(
              job.fencing_token,
              job.spec.has_heat() ? make_heat_result(of, job.spec) : make_result(of, job.spec),
              "w");
        }
      }
    }
    if (random() % 6 == 0) {
      writer_->rollback();
      held.clear();
      ASSERT_OK(writer_->begin());
      ASSERT_OK(writer_->release_all());
    }
    ASSERT_OK(writer_->commit());
    same();
  }
}

}  // namespace
}  // namespace irsig
