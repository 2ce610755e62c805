// Tests the decisions of the coordinator, without threads or sockets: the farm on a real store with
// a clock that the test sets.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "tests/unit/farm_fixture.h"

namespace irsig {
namespace {

using State = schema::CompleteReply;

TEST_F(FarmTest, AWorkerComputesEveryJobAndIsTold) {
  submit(3);
  const auto id = worker("a");
  for (int i = 0; i < 3; ++i) {
    const auto leased = job(id);
    EXPECT_EQ(status().leased(), 1U);
    EXPECT_TRUE(complete(id, leased).ok());
  }
  EXPECT_EQ(lease(id)->state(), schema::LeaseReply::STATE_FINISHED);
  EXPECT_EQ(status().done(), 3U);
  EXPECT_NEAR(status().worst_relative_error(), 2e-3, 2e-3);
}

TEST_F(FarmTest, WithoutASweepAWorkerWaits) {
  EXPECT_EQ(lease(worker("a"))->state(), schema::LeaseReply::STATE_WAIT);
}

TEST_F(FarmTest, AWorkerWaitsWhileOthersComputeTheLastJob) {
  submit(1);
  const auto a = worker("a"), b = worker("b");
  const auto leased = job(a);
  EXPECT_EQ(lease(b)->state(), schema::LeaseReply::STATE_WAIT);
  EXPECT_TRUE(complete(a, leased).ok());
  EXPECT_EQ(lease(b)->state(), schema::LeaseReply::STATE_FINISHED);
}

// A result counts by its job and content, whoever holds the lease; failures count by the lease.
TEST_F(FarmTest, AResultIsTakenByWhatItIs) {
  submit(2);
  const auto a = worker("a"), b = worker("b");
  const auto of_a = job(a), of_b = job(b);
  EXPECT_NE(of_a.fencing_token(), of_b.fencing_token());
  EXPECT_TRUE(absl::IsFailedPrecondition(fail(b, of_a, "not mine")));
  EXPECT_EQ(*returns(b, of_a), State::STATE_STORED);
  EXPECT_EQ(status().done(), 1U);
  EXPECT_EQ(*returns(a, of_a), State::STATE_KNOWN);
  EXPECT_EQ(*returns(a, of_a), State::STATE_KNOWN) << "replayed";
  EXPECT_TRUE(beat(b, of_b.fencing_token())->lease_valid());
  EXPECT_EQ(*returns(b, of_b), State::STATE_STORED);
  EXPECT_EQ(status().done(), 2U);
  EXPECT_EQ(farm_status().differing(), 0U);
  // These belong to no sweep or job that there is.
  auto elsewhere = of_b;
  elsewhere.mutable_job()->set_sweep_sha256(std::string(64, '0'));
  EXPECT_EQ(*returns(b, elsewhere), State::STATE_UNKNOWN_SWEEP);
  auto result = synthetic_result(sweep_, of_b.job());
  result.set_job_key(std::string(64, '0'));
  EXPECT_EQ(*returns(b, of_b, result), State::STATE_NOT_WANTED);
}

// The worker and its time are no content.
TEST_F(FarmTest, EqualContentIsKnownAgain) {
  submit(1);
  const auto a = worker("a"), b = worker("b");
  const auto leased = job(a);
  auto result = synthetic_result(sweep_, leased.job());
  EXPECT_EQ(*returns(a, leased, result), State::STATE_STORED);
  result.set_seconds(result.seconds() + 1);
  result.set_build_id("another build");
  EXPECT_EQ(*returns(b, leased, result), State::STATE_KNOWN);
  open("second");
  const auto c = worker("c");
  EXPECT_EQ(*returns(c, leased, result), State::STATE_KNOWN) << "the database knows it";
  EXPECT_EQ(farm_status().audited(), 1U);
}

TEST_F(FarmTest, HeartbeatsKeepALeaseAndSilenceEndsIt) {
  submit(1);
  const auto a = worker("a"), b = worker("b");
  const auto leased = job(a);
  for (int i = 0; i < 20; ++i) {
    pass(2);
    EXPECT_TRUE(beat(a, leased.fencing_token())->lease_valid());
    EXPECT_TRUE(beat(b, 0)->lease_valid());
  }
  for (int i = 0; i < 6; ++i) {  // a falls silent
    pass(2);
    EXPECT_TRUE(beat(b, 0).ok());
  }
  EXPECT_TRUE(absl::IsNotFound(beat(a, leased.fencing_token()).status()));
  const auto again = job(b);
  EXPECT_EQ(again.job().job_key(), leased.job().job_key());
  EXPECT_GT(again.fencing_token(), leased.fencing_token());
  EXPECT_TRUE(absl::IsNotFound(complete(a, leased)));
  EXPECT_TRUE(complete(b, again).ok());
}

TEST_F(FarmTest, ACoordinatorThatSleptTakesNobodyForLost) {
  submit(1);
  const auto a = worker("a");
  const auto leased = job(a);
  now_s_ += 3600;  // stopped, or the machine was suspended
  EXPECT_FALSE(farm_->somebody_is_silent());
  EXPECT_TRUE(complete(a, leased).ok());
}

// The clock of the machine is set, by an hour, forwards and back, in the middle of jobs: nobody is
// lost, results are taken, tokens go on, and silence is noticed as soon as ever.
TEST_F(FarmTest, ClocksThatJumpAnHourLoseNothing) {
  struct Jump {
    double steady_s, unix_s;
  };
  const Jump jumps[] = {{3600, 3600}, {-3600, -3600}, {0, 3600}, {0, -3600}, {3600, 0}, {-3600, 0}};
  submit(3 * std::size(jumps));
  std::uint64_t last_token = 0, done = 0;
  int round = 0;
  for (const Jump& jump : jumps) {
    SCOPED_TRACE(absl::StrCat(jump.steady_s, " s, ", jump.unix_s, " s"));
    const auto a = worker(absl::StrCat("a", ++round)), b = worker(absl::StrCat("b", round));
    const auto of_a = job(a), of_b = job(b);
    EXPECT_GT(of_a.fencing_token(), last_token);
    pass(1);
    now_s_ += jump.steady_s;
    unix_s_ += jump.unix_s;
    pass(9);
    EXPECT_TRUE(beat(a, of_a.fencing_token())->lease_valid());
    EXPECT_EQ(*returns(b, of_b), State::STATE_STORED);
    pass(9);  // of a's silence
    EXPECT_TRUE(beat(b, 0).ok());
    EXPECT_TRUE(beat(a, of_a.fencing_token())->lease_valid());
    pass(6);
    EXPECT_TRUE(beat(b, 0).ok());
    pass(5);  // 11 s, and b's 5 s
    EXPECT_TRUE(absl::IsNotFound(beat(a, of_a.fencing_token()).status()));
    const auto again = job(b);
    EXPECT_EQ(again.job().job_key(), of_a.job().job_key());
    last_token = again.fencing_token();
    EXPECT_EQ(*returns(b, again), State::STATE_STORED);
    EXPECT_EQ(status().done(), done += 2);
    EXPECT_EQ(status().quarantined(), 0U);
    // A coordinator that starts after the jump.
    open(absl::StrCat("after jump ", round));
  }
}

TEST_F(FarmTest, AWorkerThatIsStartedAgainFreesItsJobAtOnce) {
  submit(1);
  const auto old = worker("a");
  const auto leased = job(old);
  const auto young = worker("a");
  EXPECT_TRUE(absl::IsNotFound(complete(old, leased)));
  EXPECT_EQ(job(young).job().job_key(), leased.job().job_key());
}

TEST_F(FarmTest, AWorkerThatForgotItsLeaseGetsAnother) {
  submit(1);
  const auto a = worker("a");
  const auto lost_reply = job(a);
  const auto again = job(a);
  EXPECT_EQ(again.job().job_key(), lost_reply.job().job_key());
  EXPECT_EQ(*returns(a, lost_reply), State::STATE_STORED);
  EXPECT_EQ(*returns(a, again), State::STATE_KNOWN);
}

TEST_F(FarmTest, AJobThatFailsOnThreeWorkersIsQuarantinedWithItsMessages) {
  submit(1);
  const std::string names[] = {"a", "b", "c"};
  std::vector<std::string> ids;
  for (const auto& name : names) ids.push_back(worker(name));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(status().quarantined(), 0U);
    EXPECT_TRUE(fail(ids[static_cast<std::size_t>(i)], job(ids[static_cast<std::size_t>(i)]),
                     "no luck on " + names[i])
                    .ok());
  }
  EXPECT_EQ(status().quarantined(), 1U);
  ASSERT_GE(status().failure_size(), 1);
  EXPECT_THAT(status().failure(0), testing::HasSubstr("no luck on"));
  EXPECT_EQ(lease(ids[0])->state(), schema::LeaseReply::STATE_FINISHED);
}

TEST_F(FarmTest, OneBadWorkerDoesNotQuarantineWhileOthersCanTry) {
  submit(1);
  const auto bad = worker("bad"), good = worker("good");
  EXPECT_TRUE(fail(bad, job(bad), "disk").ok());
  EXPECT_EQ(lease(bad)->state(), schema::LeaseReply::STATE_WAIT);  // left to the other
  EXPECT_TRUE(complete(good, job(good)).ok());
  EXPECT_EQ(status().done(), 1U);
}

TEST_F(FarmTest, ASingleWorkerSettlesAFailingJobToo) {
  submit(1);
  const auto only = worker("only");
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(fail(only, job(only), "always").ok());
  EXPECT_EQ(status().quarantined(), 1U);
}

TEST_F(FarmTest, AJobThatKillsItsWorkersIsQuarantinedInTheEnd) {
  submit(1);
  int deaths = 0;
  for (; status().quarantined() == 0 && deaths < 50; ++deaths) {
    const auto id = worker("a");  // started again after its death
    if (lease(id)->state() != schema::LeaseReply::STATE_LEASED) break;
  }
  EXPECT_EQ(status().quarantined(), 1U);
  EXPECT_EQ(deaths, 8);  // 5 tolerated, 3 counted
}

// One after the other, on three workers: whatever else happens to them, it is the job.
TEST_F(FarmTest, AJobThatThreeWorkersAreLostWithIsGivenUp) {
  submit(1);
  for (const char* name : {"a", "b", "c"}) {
    EXPECT_EQ(status().quarantined(), 0U) << name;
    (void)job(worker(name));
    (void)worker(name);
  }
  EXPECT_EQ(status().quarantined(), 1U);
  EXPECT_THAT(status().failure(0), testing::HasSubstr("3 workers were lost with it: a, b, c"));
}

TEST_F(FarmTest, LossesBeforeARestartDoNotCount) {
  submit(1);
  for (int start = 0; start < 4; ++start) {
    for (const std::string name : {"a", "b"}) {
      (void)job(worker(name + std::to_string(start)));
      (void)worker(name + std::to_string(start));
    }
    EXPECT_EQ(status().quarantined(), 0U);
    open("start " + std::to_string(start));
  }
}

// A machine that ends, or a switch: several workers at once, again and again.
TEST_F(FarmTest, WhatTakesSeveralWorkersAtOnceIsNoFaultOfTheirJobs) {
  submit(2);
  for (int wave = 0; wave < 20; ++wave) {
    (void)job(worker("a" + std::to_string(wave)));
    (void)job(worker("b" + std::to_string(wave)));
    pass(11);
    EXPECT_EQ(status().leased(), 0U);
  }
  EXPECT_EQ(status().quarantined(), 0U);
}

TEST_F(FarmTest, BadInputAndGuardsAreNotTriedAgain) {
  submit(2);
  const auto a = worker("a");
  EXPECT_TRUE(fail(a, job(a), "no such material", schema::FailRequest::KIND_BAD_INPUT).ok());
  EXPECT_EQ(status().quarantined(), 1U);
  EXPECT_TRUE(fail(a, job(a), "weights not finite", schema::FailRequest::KIND_GUARD).ok());
  EXPECT_EQ(status().quarantined(), 2U);
  EXPECT_THAT(status().failure(),
              testing::UnorderedElementsAre(testing::HasSubstr("no such material"),
                                            testing::HasSubstr("weights not finite")));
}

TEST_F(FarmTest, OutOfMemoryIsTriedOnceMoreWhereThereIsMore) {
  const auto with_memory = [&](const std::string& name, std::uint64_t bytes) {
    return try_worker(name, kSyntheticClass, 1, bytes)->worker_id();
  };
  constexpr auto kKind = schema::FailRequest::KIND_OUT_OF_MEMORY;
  submit(1);
  const auto small = with_memory("small", 4'000'000'000), same = with_memory("same", 4'400'000'000);
  const auto large = with_memory("large", 16'000'000'000);
  EXPECT_TRUE(fail(small, job(small), "out of memory", kKind).ok());
  EXPECT_EQ(lease(small)->state(), schema::LeaseReply::STATE_WAIT);
  EXPECT_EQ(lease(same)->state(), schema::LeaseReply::STATE_WAIT);
  EXPECT_EQ(status().quarantined(), 0U);
  EXPECT_TRUE(fail(large, job(large), "out of memory", kKind).ok());
  EXPECT_EQ(status().quarantined(), 1U);
  EXPECT_THAT(status().failure(0), testing::HasSubstr("(16 GB)"));
}

TEST_F(FarmTest, OutOfMemoryEverywhereIsSaidAtOnce) {
  submit(1);
  const auto only = try_worker("only", kSyntheticClass, 1, 4'000'000'000)->worker_id();
  EXPECT_TRUE(fail(only, job(only), "out of memory", schema::FailRequest::KIND_OUT_OF_MEMORY).ok());
  EXPECT_EQ(status().quarantined(), 1U);
  EXPECT_THAT(status().failure(0), testing::HasSubstr("(4 GB; no worker has more)"));
}

// Given up, and then somebody's spool has it: with what was given up because of it.
TEST_F(FarmTest, AResultOfAQuarantinedJobIsTaken) {
  sweep_ = heated_frigate_sweep(2);
  const auto submission = make_submission(check_resolved, sweep_, 1, {});
  ASSERT_TRUE(submission.ok());
  ASSERT_TRUE(ask([&] { return farm_->submit(*submission); }).ok());
  const auto a = worker("a"), b = worker("b");
  const auto heat = job(a);
  ASSERT_TRUE(heat.job().has_heat());
  EXPECT_TRUE(fail(a, heat, "cursed", schema::FailRequest::KIND_BAD_INPUT).ok());
  EXPECT_EQ(status().quarantined(), 3U);
  EXPECT_EQ(*returns(b, heat), State::STATE_STORED);
  EXPECT_EQ(status().quarantined(), 0U);
  while (status().done() < status().jobs()) ASSERT_TRUE(complete(a, job(a)).ok());
}

// Three different jobs, and others do them: it is the worker. Where nobody can do them, it is not.
TEST_F(FarmTest, AWorkerThatFailsWhatOthersDoIsSetAside) {
  submit(5);
  const auto bad = worker("bad"), good = worker("good");
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(fail(bad, job(bad), "no disk").ok());
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(complete(good, job(good)).ok());
  EXPECT_EQ(farm_status().worker(0).state(), schema::WorkerStatus::STATE_IDLE);
  EXPECT_TRUE(complete(good, job(good)).ok());
  const auto told = farm_status().worker(0);
  EXPECT_EQ(told.name(), "bad");
  EXPECT_EQ(told.state(), schema::WorkerStatus::STATE_SET_ASIDE);
  EXPECT_THAT(told.reason(), testing::HasSubstr("3 jobs failed on it and were done by others"));
  EXPECT_TRUE(absl::IsAborted(lease(bad).status()));
  EXPECT_TRUE(absl::IsAborted(try_worker("bad").status())) << "nor under its name";
  EXPECT_EQ(status().done(), 5U);
}

TEST_F(FarmTest, WorkersThatFailWhatNobodyCanDoAreNot) {
  submit(5);
  const std::string ids[] = {worker("a"), worker("b"), worker("c")};
  for (int i = 0; i < 15; ++i) {
    const auto reply = lease(ids[i % 3]);
    ASSERT_TRUE(reply.ok()) << reply.status();
    if (reply->state() == schema::LeaseReply::STATE_LEASED) {
      EXPECT_TRUE(fail(ids[i % 3], *reply, "cursed").ok());
    }
  }
  EXPECT_EQ(status().quarantined(), 5U);
  const auto told = farm_status();
  for (const auto& one : told.worker()) EXPECT_EQ(one.state(), schema::WorkerStatus::STATE_IDLE);
}

TEST_F(FarmTest, AResultThatDoesNotFitItsJobCountsAsAFailure) {
  submit(2);
  const auto a = worker("a");
  const auto leased = job(a);
  auto wrong = synthetic_result(sweep_, leased.job());
  wrong.mutable_view()->mutable_row()->RemoveLast();
  EXPECT_TRUE(absl::IsInvalidArgument(returns(a, leased, wrong).status()));
  EXPECT_EQ(status().done(), 0U);
  EXPECT_EQ(status().leased(), 0U);
}

TEST_F(FarmTest, ARestartFreesLeasesAndKeepsResults) {
  submit(2);
  const auto a = worker("a");
  EXPECT_TRUE(complete(a, job(a)).ok());
  const auto leased = job(a);
  open("second");
  EXPECT_EQ(status().done(), 1U);
  EXPECT_EQ(status().leased(), 0U);
  EXPECT_TRUE(absl::IsNotFound(complete(a, leased)));
  const auto again = worker("a");
  EXPECT_NE(again, a);
  const auto fresh = job(again);
  EXPECT_EQ(fresh.job().job_key(), leased.job().job_key());
  EXPECT_GT(fresh.fencing_token(), leased.fencing_token());
  // The result was computed before the restart, and comes from a spool now.
  EXPECT_EQ(*returns(again, leased), State::STATE_STORED);
  EXPECT_EQ(*returns(again, fresh), State::STATE_KNOWN);
  EXPECT_EQ(status().done(), 2U);
}

TEST_F(FarmTest, AnotherDeterminismClassIsRefused) {
  submit(2);
  const auto a = worker("a");
  EXPECT_TRUE(complete(a, job(a)).ok());
  const auto other = try_worker("b", "another class");
  EXPECT_TRUE(absl::IsFailedPrecondition(other.status()));
  EXPECT_THAT(
      std::string(other.status().message()),
      testing::AllOf(testing::HasSubstr(kSyntheticClass), testing::HasSubstr("another class")));
  const schema::StatusReply told = farm_status();
  ASSERT_EQ(told.warning_size(), 1);
  EXPECT_THAT(told.warning(0), testing::AllOf(testing::HasSubstr("worker b computes nothing"),
                                              testing::HasSubstr("another class")));
  EXPECT_TRUE(try_worker("b", kSyntheticClass).ok());
  EXPECT_EQ(farm_status().warning_size(), 0);
}

TEST_F(FarmTest, AClassThatWasFreeAtRegistrationIsCheckedAtTheLease) {
  submit(2);
  const auto other = try_worker("b", "another class");
  ASSERT_TRUE(other.ok());
  const auto a = worker("a");
  (void)job(a);
  EXPECT_TRUE(absl::IsFailedPrecondition(lease(other->worker_id()).status()));
  EXPECT_EQ(farm_status().warning_size(), 1);
}

TEST_F(FarmTest, AnotherPhysicsVersionIsRefusedAndLeavesTheJobFree) {
  submit(1);
  const auto old = try_worker("old", kSyntheticClass, 7);
  ASSERT_TRUE(old.ok());
  EXPECT_TRUE(absl::IsFailedPrecondition(lease(old->worker_id()).status()));
  const auto a = worker("a");
  EXPECT_TRUE(complete(a, job(a)).ok());
}

// After a restart, too: what the keys were made with is in the database.
TEST_F(FarmTest, AnotherPhysicsVersionIsRefusedAfterARestart) {
  submit(1);
  open("second");
  const auto old = try_worker("old", kSyntheticClass, 7);
  ASSERT_TRUE(old.ok());
  for (int i = 0; i < 2; ++i)
    EXPECT_TRUE(absl::IsFailedPrecondition(lease(old->worker_id()).status()));
  EXPECT_EQ(*store_->physics_version(status().sweep_sha256()), 1U);
  // A database without a stated version is known by its keys.
  ASSERT_TRUE(ask([&] { return store_->set_physics_version(status().sweep_sha256(), 2); }).ok());
  open("third");
  EXPECT_TRUE(absl::IsFailedPrecondition(lease(worker("a")).status()));
}

TEST_F(FarmTest, AStatusTellsRatesHostsAndWhatIsTriedAgain) {
  submit(5);
  schema::RegisterRequest request;
  request.set_worker_name("a");
  request.set_host("node7");
  request.set_determinism_class(kSyntheticClass);
  request.set_physics_version(1);
  const auto a = ask([&] { return farm_->register_worker(request); })->worker_id();
  EXPECT_EQ(status().done_per_s(), 0);
  for (int i = 0; i < 3; ++i) {
    const auto leased = job(a);
    now_s_ += 4;
    ASSERT_TRUE(complete(a, leased).ok());
  }
  EXPECT_NEAR(status().done_per_s(), 0.25, 1e-12);
  ASSERT_TRUE(fail(a, job(a), "out of luck").ok());
  const auto told = farm_status();
  ASSERT_EQ(told.recent_failure_size(), 1);
  EXPECT_THAT(told.recent_failure(0), testing::HasSubstr("on a: out of luck"));
  EXPECT_EQ(told.worker(0).host(), "node7");
  now_s_ += 3599;
  EXPECT_GT(status().done_per_s(), 0);
  now_s_ += 2;
  EXPECT_EQ(status().done_per_s(), 0) << "long ago";
  request.set_host("two\nlines");
  EXPECT_TRUE(
      absl::IsInvalidArgument(ask([&] { return farm_->register_worker(request); }).status()));
}

TEST_F(FarmTest, CancelledJobsAreNotLeasedAndTheirResultsAreNotWanted) {
  submit(3);
  const auto a = worker("a");
  const auto leased = job(a);
  const auto sha = status().sweep_sha256();
  const auto reply = ask([&] { return farm_->cancel(sha); });
  ASSERT_TRUE(reply.ok());
  EXPECT_EQ(reply->cancelled(), 3U);
  EXPECT_EQ(*returns(a, leased), State::STATE_NOT_WANTED);
  EXPECT_EQ(status().done(), 0U);
  EXPECT_EQ(lease(a)->state(), schema::LeaseReply::STATE_FINISHED);
}

TEST_F(FarmTest, JobsOfTheHighestPriorityComeFirst) {
  const auto add = [&](const char* name, std::optional<int> priority) {
    auto submission = make_submission(check_resolved, frigate_sweep(2, name), 1, {});
    ASSERT_TRUE(submission.ok());
    submission->priority = priority;
    ASSERT_TRUE(ask([&] { return farm_->submit(*submission); }).ok());
  };
  const auto a = worker("a");
  sweep_ = frigate_sweep(2);  // as all of them, but for the name
  const auto sweep_of = [&](const schema::LeaseReply& lease) {
    const auto now = farm_status();
    for (const auto& sweep : now.sweep())
      if (sweep.sweep_sha256() == lease.job().sweep_sha256()) return sweep.name();
    return std::string();
  };
  std::vector<std::string> order;
  const auto next = [&] {
    const auto leased = job(a);
    order.push_back(sweep_of(leased));
    ASSERT_TRUE(complete(a, leased).ok());
  };
  add("first", std::nullopt);
  next();
  add("urgent", 5);  // while the first is under way
  next();
  add("idle", -5);
  schema::PrioritizeRequest request;
  const auto now = farm_status();
  for (const auto& sweep : now.sweep())
    if (sweep.name() == "first") request.set_sweep_sha256(sweep.sweep_sha256());
  request.set_priority(6);
  ASSERT_TRUE(ask([&] { return farm_->prioritize(request); }).ok());
  for (int i = 0; i < 4; ++i) next();
  EXPECT_EQ(order,
            (std::vector<std::string>{"first", "urgent", "first", "urgent", "idle", "idle"}));
}

// A sweep whose jobs wait for others has nothing to give: the next one goes on meanwhile.
TEST_F(FarmTest, WhatWaitsForOtherJobsHoldsNothingUp) {
  sweep_ = heated_frigate_sweep(1, "heated");
  auto heated = make_submission(check_resolved, sweep_, 1, {});
  ASSERT_TRUE(heated.ok());
  heated->priority = 1;
  ASSERT_TRUE(ask([&] { return farm_->submit(*heated); }).ok());
  const auto views = make_submission(check_resolved, frigate_sweep(1, "views"), 1, {});
  ASSERT_TRUE(views.ok());
  ASSERT_TRUE(ask([&] { return farm_->submit(*views); }).ok());
  for (int heat = 0; heat < sweep_.heat_size(); ++heat)
    EXPECT_TRUE(job(worker(absl::StrCat("a", heat))).job().has_heat());
  EXPECT_EQ(job(worker("b")).job().sweep_sha256(), views->sweep_sha256);
}

// A pilot's sweeps differ in nothing that temperatures depend on.
TEST_F(FarmTest, TemperaturesAreComputedOnceForAllSweepsThatShareThem) {
  const auto id = worker("a");
  std::vector<std::string> computed;
  for (const char* name : {"pilot 1", "pilot 2"}) {
    sweep_ = heated_frigate_sweep(2, name);
    const auto submission = make_submission(check_resolved, sweep_, 1, {});
    ASSERT_TRUE(submission.ok());
    ASSERT_TRUE(ask([&] { return farm_->submit(*submission); }).ok());
    for (;;) {
      const auto reply = lease(id);
      ASSERT_TRUE(reply.ok()) << reply.status();
      if (reply->state() == schema::LeaseReply::STATE_FINISHED) break;
      ASSERT_EQ(reply->state(), schema::LeaseReply::STATE_LEASED);
      computed.emplace_back(reply->job().has_heat() ? "heat" : "view");
      EXPECT_EQ(reply->output_size(), reply->job().has_heat() ? 0 : sweep_.heat_size());
      for (const auto& output : reply->output()) EXPECT_TRUE(farm_->asset(output.sha256()).ok());
      ASSERT_TRUE(complete(id, *reply).ok());
    }
  }
  std::vector<std::string> expected(static_cast<std::size_t>(sweep_.heat_size()), "heat");
  expected.insert(expected.end(), 4, "view");
  EXPECT_EQ(computed, expected);
}

}  // namespace
}  // namespace irsig
