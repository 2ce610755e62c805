// What the coordinator decides, without threads or sockets: the session table row by row, and the
// farm on a real store with a clock that the test sets.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "coordinator/farm.h"
#include "coordinator/session.h"
#include "tests/fault/synthetic_farm.h"

namespace irsig {
namespace {

using S = SessionState;
using E = SessionEvent;
using A = SessionAction;

TEST(Session, EveryRowOfTheTable) {
  struct Row {
    S state;
    E event;
    SessionStep step;
  };
  const Row rows[] = {
      {S::kIdle, E::kAskForJob, {S::kIdle, A::kLease}},
      {S::kIdle, E::kHeartbeat, {S::kIdle, A::kNone}},
      {S::kIdle, E::kForeignHeartbeat, {S::kIdle, A::kAnswerInvalid}},
      {S::kIdle, E::kReturn, {S::kIdle, A::kRefuse}},
      {S::kIdle, E::kForeignReturn, {S::kIdle, A::kRefuse}},
      {S::kIdle, E::kSilence, {S::kLost, A::kNone}},
      {S::kIdle, E::kSuccessor, {S::kLost, A::kNone}},
      {S::kComputing, E::kAskForJob, {S::kIdle, A::kReleaseThenLease}},
      {S::kComputing, E::kHeartbeat, {S::kComputing, A::kNone}},
      {S::kComputing, E::kForeignHeartbeat, {S::kComputing, A::kAnswerInvalid}},
      {S::kComputing, E::kReturn, {S::kIdle, A::kSettle}},
      {S::kComputing, E::kForeignReturn, {S::kComputing, A::kRefuse}},
      {S::kComputing, E::kSilence, {S::kLost, A::kRelease}},
      {S::kComputing, E::kSuccessor, {S::kLost, A::kRelease}},
      {S::kLost, E::kAskForJob, {S::kLost, A::kRefuse}},
      {S::kLost, E::kHeartbeat, {S::kLost, A::kRefuse}},
      {S::kLost, E::kForeignHeartbeat, {S::kLost, A::kRefuse}},
      {S::kLost, E::kReturn, {S::kLost, A::kRefuse}},
      {S::kLost, E::kForeignReturn, {S::kLost, A::kRefuse}},
      {S::kLost, E::kSilence, {S::kLost, A::kRefuse}},
      {S::kLost, E::kSuccessor, {S::kLost, A::kRefuse}},
  };
  for (const Row& row : rows) {
    EXPECT_EQ(next(row.state, row.event), row.step)
        << "state " << static_cast<int>(row.state) << ", event " << static_cast<int>(row.event);
  }
}

class FarmTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::TempDir() + "/farm-" + std::to_string(getpid()) + "-" +
              testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    open("first");
  }
  void TearDown() override {
    farm_.reset();
    store_.reset();
    std::filesystem::remove_all(folder_);
  }

  // A coordinator starts, or starts again, on the same database.
  void open(const std::string& coordinator_id) {
    farm_.reset();
    store_.reset();
    auto store = StoreWriter::open(folder_ + "/test.sigdb");
    ASSERT_TRUE(store.ok()) << store.status();
    store_ = *std::move(store);
    ASSERT_TRUE(store_->begin().ok());
    ASSERT_TRUE(store_->release_all().ok());
    ASSERT_TRUE(store_->commit().ok());
    farm_ = std::make_unique<Farm>(
        *store_, FarmRules{2, 10, 5}, [this] { return now_s_; }, [] { return 1.7e9; },
        coordinator_id);
  }

  template <class Ask>
  auto ask(Ask call) {
    EXPECT_TRUE(store_->begin().ok());
    auto answer = call();
    EXPECT_TRUE(store_->commit().ok());
    return answer;
  }

  void submit(std::uint32_t viewpoints) {
    sweep_ = frigate_sweep(viewpoints);
    auto submission = make_submission(sweep_, 1, {});
    ASSERT_TRUE(submission.ok());
    const auto reply = ask([&] { return farm_->submit(*submission); });
    ASSERT_TRUE(reply.ok()) << reply.status();
  }

  absl::StatusOr<schema::RegisterReply> try_worker(const std::string& name,
                                                   const std::string& klass = kSyntheticClass,
                                                   std::uint32_t physics_version = 1) {
    schema::RegisterRequest request;
    request.set_worker_name(name);
    request.set_determinism_class(klass);
    request.set_physics_version(physics_version);
    return ask([&] { return farm_->register_worker(request); });
  }
  std::string worker(const std::string& name) {
    const auto reply = try_worker(name);
    EXPECT_TRUE(reply.ok()) << reply.status();
    return reply.ok() ? reply->worker_id() : "";
  }

  absl::StatusOr<schema::LeaseReply> lease(const std::string& worker_id) {
    schema::LeaseRequest request;
    request.set_worker_id(worker_id);
    return ask([&] { return farm_->lease(request); });
  }
  schema::LeaseReply job(const std::string& worker_id) {
    const auto reply = lease(worker_id);
    EXPECT_TRUE(reply.ok()) << reply.status();
    if (!reply.ok()) return {};
    EXPECT_EQ(reply->state(), schema::LeaseReply::STATE_LEASED);
    return *reply;
  }

  absl::Status complete(const std::string& worker_id, const schema::LeaseReply& lease) {
    const auto result = synthetic_result(sweep_, lease.job());
    return ask([&] { return farm_->complete(worker_id, lease.fencing_token(), result); });
  }
  absl::Status fail(const std::string& worker_id, const schema::LeaseReply& lease,
                    const std::string& message) {
    schema::FailRequest request;
    request.set_worker_id(worker_id);
    request.set_fencing_token(lease.fencing_token());
    request.set_message(message);
    return ask([&] { return farm_->fail(request); });
  }
  absl::StatusOr<schema::HeartbeatReply> beat(const std::string& worker_id, std::uint64_t token) {
    schema::HeartbeatRequest request;
    request.set_worker_id(worker_id);
    request.set_fencing_token(token);
    return farm_->heartbeat(request);
  }
  // Time passes as the commit loop sees it: in steps short against the timeout.
  void pass(double seconds) {
    for (const double end = now_s_ + seconds; now_s_ < end;) {
      now_s_ = std::min(end, now_s_ + 1);
      if (farm_->somebody_is_silent()) {
        ASSERT_TRUE(ask([&] { return farm_->drop_silent_workers(); }).ok());
      }
    }
  }
  schema::SweepStatus status() {
    const auto reply = farm_->status();
    EXPECT_TRUE(reply.ok() && reply->sweep_size() == 1);
    return reply->sweep(0);
  }

  std::string folder_;
  double now_s_ = 1000;
  std::unique_ptr<StoreWriter> store_;
  std::unique_ptr<Farm> farm_;
  schema::ResolvedSweep sweep_;
};

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

TEST_F(FarmTest, AForeignOrRepeatedResultIsRefused) {
  submit(2);
  const auto a = worker("a"), b = worker("b");
  const auto of_a = job(a), of_b = job(b);
  EXPECT_NE(of_a.fencing_token(), of_b.fencing_token());
  EXPECT_TRUE(absl::IsFailedPrecondition(complete(b, of_a)));
  EXPECT_TRUE(absl::IsFailedPrecondition(fail(b, of_a, "not mine")));
  EXPECT_TRUE(complete(a, of_a).ok());
  EXPECT_TRUE(absl::IsFailedPrecondition(complete(a, of_a)));
  EXPECT_TRUE(complete(b, of_b).ok());
  EXPECT_EQ(status().done(), 2U);
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
  EXPECT_TRUE(absl::IsFailedPrecondition(complete(a, lost_reply)));
  EXPECT_TRUE(complete(a, again).ok());
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

TEST_F(FarmTest, AResultThatDoesNotFitItsJobCountsAsAFailure) {
  submit(2);
  const auto a = worker("a");
  const auto leased = job(a);
  auto wrong = synthetic_result(sweep_, leased.job());
  wrong.mutable_view()->mutable_row()->RemoveLast();
  EXPECT_TRUE(absl::IsInvalidArgument(
      ask([&] { return farm_->complete(a, leased.fencing_token(), wrong); })));
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
  EXPECT_TRUE(absl::IsFailedPrecondition(complete(again, leased)));
  const auto fresh = job(again);
  EXPECT_EQ(fresh.job().job_key(), leased.job().job_key());
  EXPECT_GT(fresh.fencing_token(), leased.fencing_token());
  EXPECT_TRUE(complete(again, fresh).ok());
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
}

TEST_F(FarmTest, AClassThatWasFreeAtRegistrationIsCheckedAtTheLease) {
  submit(2);
  const auto other = try_worker("b", "another class");
  ASSERT_TRUE(other.ok());
  const auto a = worker("a");
  (void)job(a);
  EXPECT_TRUE(absl::IsFailedPrecondition(lease(other->worker_id()).status()));
}

TEST_F(FarmTest, AnotherPhysicsVersionIsRefusedAndLeavesTheJobFree) {
  submit(1);
  const auto old = try_worker("old", kSyntheticClass, 7);
  ASSERT_TRUE(old.ok());
  EXPECT_TRUE(absl::IsFailedPrecondition(lease(old->worker_id()).status()));
  const auto a = worker("a");
  EXPECT_TRUE(complete(a, job(a)).ok());
}

TEST_F(FarmTest, CancelledJobsAreNotLeasedAndTheirResultsAreRefused) {
  submit(3);
  const auto a = worker("a");
  const auto leased = job(a);
  const auto sha = status().sweep_sha256();
  const auto reply = ask([&] { return farm_->cancel(sha); });
  ASSERT_TRUE(reply.ok());
  EXPECT_EQ(reply->cancelled(), 3U);
  EXPECT_TRUE(absl::IsFailedPrecondition(complete(a, leased)));
  EXPECT_EQ(lease(a)->state(), schema::LeaseReply::STATE_FINISHED);
}

// As a pilot does: sweeps that differ in nothing that temperatures depend on.
TEST_F(FarmTest, TemperaturesAreComputedOnceForAllSweepsThatShareThem) {
  const auto id = worker("a");
  std::vector<std::string> computed;
  for (const char* name : {"pilot 1", "pilot 2"}) {
    sweep_ = heated_frigate_sweep(2, name);
    const auto submission = make_submission(sweep_, 1, {});
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
