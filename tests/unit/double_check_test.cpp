// Jobs that are computed by two workers: audits, stragglers, and results that differ.
#include "coordinator/double_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "jobs/keys/expand.h"
#include "tests/unit/farm_fixture.h"
#include "schema/store/reader.h"

namespace irsig {
namespace {

using testing::HasSubstr;
using State = schema::CompleteReply;
using CheckedWorker = schema::WorkerStatus;

// The share of 10^5 keys, within four standard deviations; another start chooses others.
TEST(DoubleCheckShare, IsWhatIsAskedFor) {
  constexpr int kJobs = 100000;
  for (const double share : {0.0, 0.005, 0.3, 1.0}) {
    const DoubleCheck check(share, "salt"), other(share, "other");
    int chosen = 0, both = 0;
    for (int i = 0; i < kJobs; ++i) {
      const JobName job{"sweep", sha256_hex(std::to_string(i))};
      chosen += check.chosen(job) ? 1 : 0;
      both += check.chosen(job) && other.chosen(job) ? 1 : 0;
    }
    const double sigma = std::sqrt(kJobs * share * (1 - share));
    EXPECT_NEAR(chosen, kJobs * share, 4 * sigma) << share;
    EXPECT_NEAR(both, kJobs * share * share,
                4 * std::sqrt(kJobs * share * share * (1 - share * share)))
        << share;
  }
}

class AuditTest : public FarmTest {
 protected:
  void SetUp() override {
    rules_.audit_fraction = 1;
    FarmTest::SetUp();
  }
  CheckedWorker::State state_of(const std::string& name) {
    const auto told = farm_status();
    for (const auto& worker : told.worker())
      if (worker.name() == name) return worker.state();
    return CheckedWorker::STATE_UNSPECIFIED;
  }
};

TEST_F(AuditTest, EveryJobIsComputedByTwoWorkersAndStoredOnce) {
  submit(3);
  const auto a = worker("a"), b = worker("b");
  std::multiset<std::string> computed;
  for (int i = 0; i < 20; ++i) {
    const auto& id = i % 2 == 0 ? a : b;
    const auto reply = lease(id);
    ASSERT_TRUE(reply.ok());
    if (reply->state() != schema::LeaseReply::STATE_LEASED) continue;
    computed.insert(reply->job().job_key());
    EXPECT_TRUE(beat(id, reply->fencing_token())->lease_valid());
    ASSERT_TRUE(complete(id, *reply).ok());
  }
  EXPECT_EQ(computed.size(), 6U);
  for (const auto& key : computed) EXPECT_EQ(computed.count(key), 2U);
  EXPECT_EQ(status().done(), 3U);
  EXPECT_EQ(farm_status().audited(), 3U);
  EXPECT_EQ(farm_status().differing(), 0U);
  EXPECT_EQ(lease(a)->state(), schema::LeaseReply::STATE_FINISHED);
}

TEST_F(AuditTest, AWorkerAloneIsNotAudited) {
  submit(3);
  const auto a = worker("a");
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(complete(a, job(a)).ok());
  EXPECT_EQ(lease(a)->state(), schema::LeaseReply::STATE_FINISHED);
  EXPECT_EQ(lease(worker("b"))->state(), schema::LeaseReply::STATE_FINISHED)
      << "who comes later finds nothing to do";
}

// Without anybody to decide nobody is to blame, whoever came first; a later worker decides.
TEST_F(AuditTest, OfTwoThatDifferNobodyIsToBlameUntilAThirdComes) {
  for (const bool first_is_wrong : {true, false}) {
    SCOPED_TRACE(first_is_wrong);
    folder_ += first_is_wrong ? "/first" : "/second";
    std::filesystem::create_directories(folder_);
    open("it");
    submit(1);
    const auto a = worker("a"), b = worker("b");
    const auto first = job(a);
    ASSERT_TRUE((first_is_wrong ? returns(a, first, wrong_result(first)) : returns(a, first)).ok());
    const auto audit = job(b);
    EXPECT_EQ(*(first_is_wrong ? returns(b, audit) : returns(b, audit, wrong_result(audit))),
              State::STATE_ASIDE);
    for (const char* name : {"a", "b"})
      EXPECT_EQ(state_of(name), CheckedWorker::STATE_IDLE) << name;
    const auto told = farm_status();
    EXPECT_EQ(told.differing(), 1U);
    ASSERT_EQ(told.warning_size(), 1);
    EXPECT_THAT(told.warning(0), HasSubstr("of a, which is stored, and of b, which is kept aside"));
    const auto c = worker("c");
    const auto decides = job(c);
    EXPECT_EQ(decides.job().job_key(), audit.job().job_key());
    EXPECT_EQ(*returns(c, decides), first_is_wrong ? State::STATE_STORED : State::STATE_KNOWN);
    EXPECT_EQ(state_of("a"),
              first_is_wrong ? CheckedWorker::STATE_SET_ASIDE : CheckedWorker::STATE_IDLE);
    EXPECT_EQ(state_of("b"),
              first_is_wrong ? CheckedWorker::STATE_IDLE : CheckedWorker::STATE_SET_ASIDE);
  }
  // The database remembers.
  open("third");
  EXPECT_EQ(farm_status().differing(), 1U);
}

// Whose right result lost to a wrong one is right again when that one is thrown away.
TEST_F(AuditTest, WhoeverDifferedFromWhatWasWrongIsNotToBlame) {
  submit(2);
  const auto a = worker("a"), b = worker("b"), c = worker("c");
  const auto one = job(a);
  ASSERT_EQ(*returns(a, one, wrong_result(one)), State::STATE_STORED);
  const auto two = job(a);
  ASSERT_EQ(*returns(a, two, wrong_result(two)), State::STATE_STORED);
  EXPECT_EQ(*returns(b, one), State::STATE_ASIDE);
  EXPECT_EQ(*returns(b, two), State::STATE_ASIDE);
  EXPECT_EQ(*returns(c, one), State::STATE_STORED);  // and so a is wrong, in two as well
  EXPECT_EQ(state_of("a"), CheckedWorker::STATE_SET_ASIDE);
  EXPECT_EQ(*returns(c, two), State::STATE_STORED);
  EXPECT_EQ(*returns(b, two), State::STATE_KNOWN);
  for (const char* name : {"b", "c"}) EXPECT_EQ(state_of(name), CheckedWorker::STATE_IDLE) << name;
}

TEST_F(AuditTest, AThirdWorkerDecidesForWhatIsStored) {
  submit(1);
  const auto a = worker("a"), b = worker("b"), c = worker("c");
  ASSERT_TRUE(complete(a, job(a)).ok());
  const auto audit = job(b);
  EXPECT_EQ(*returns(b, audit, wrong_result(audit)), State::STATE_ASIDE);
  EXPECT_EQ(state_of("b"), CheckedWorker::STATE_IDLE) << "nobody knows yet";
  const auto decides = job(c);
  EXPECT_EQ(decides.job().job_key(), audit.job().job_key());
  EXPECT_EQ(*returns(c, decides), State::STATE_KNOWN);
  EXPECT_EQ(state_of("b"), CheckedWorker::STATE_SET_ASIDE);
  EXPECT_EQ(state_of("a"), CheckedWorker::STATE_IDLE);
}

TEST_F(AuditTest, AThirdWorkerDecidesAgainstWhatIsStored) {
  submit(1);
  const auto a = worker("a"), b = worker("b"), c = worker("c");
  const auto first = job(a);
  ASSERT_EQ(*returns(a, first, wrong_result(first)), State::STATE_STORED);
  const auto audit = job(b);
  EXPECT_EQ(*returns(b, audit), State::STATE_ASIDE);
  const auto decides = job(c);
  EXPECT_EQ(*returns(c, decides), State::STATE_STORED) << "in place of the wrong one";
  EXPECT_EQ(state_of("a"), CheckedWorker::STATE_SET_ASIDE);
  EXPECT_EQ(state_of("b"), CheckedWorker::STATE_IDLE);
  EXPECT_EQ(status().done(), 1U);
  EXPECT_EQ(*returns(b, audit), State::STATE_KNOWN);
  // The outcome is as if it had been right at once.
  const auto here = StoreReader::open(folder_ + "/test.sigdb");
  ASSERT_TRUE(here.ok());
  const auto digest = (*here)->digest();
  rules_.audit_fraction = 0;
  folder_ += "/calm";
  std::filesystem::create_directories(folder_);
  open("calm");
  submit(1);
  const auto d = worker("d");
  ASSERT_TRUE(complete(d, job(d)).ok());
  const auto calm = StoreReader::open(folder_ + "/test.sigdb");
  ASSERT_TRUE(calm.ok());
  EXPECT_EQ(*digest, *(*calm)->digest());
}

// A worker that was wrong once may have been before: others compute again what it had computed.
TEST_F(AuditTest, WhatAContradictedWorkerHadComputedIsComputedAgain) {
  rules_.audit_fraction = 0;
  open("no audits");
  submit(6);
  const auto a = worker("a"), b = worker("b"), c = worker("c");
  std::vector<schema::LeaseReply> of_a;
  for (int i = 0; i < 3; ++i) {
    of_a.push_back(job(a));
    ASSERT_EQ(*returns(a, of_a.back(), wrong_result(of_a.back())), State::STATE_STORED);
  }
  ASSERT_TRUE(complete(b, job(b)).ok());
  EXPECT_EQ(status().done(), 4U);
  EXPECT_EQ(*returns(b, of_a[0]), State::STATE_ASIDE);
  EXPECT_EQ(*returns(c, of_a[0]), State::STATE_STORED);
  EXPECT_EQ(state_of("a"), CheckedWorker::STATE_SET_ASIDE);
  EXPECT_THAT(farm_status().worker(0).reason(), HasSubstr("(3 jobs) is computed again"));
  EXPECT_EQ(status().done(), 2U);
  while (status().done() < 6) ASSERT_TRUE(complete(c, job(c)).ok());
  for (const auto& one : of_a) EXPECT_EQ(*returns(b, one), State::STATE_KNOWN);
}

// Three opinions of one job: its numbers are no function of what determines them.
TEST_F(AuditTest, WhereAllDifferNobodyIsToBlame) {
  submit(1);
  const auto a = worker("a"), b = worker("b"), c = worker("c"), d = worker("d");
  ASSERT_TRUE(complete(a, job(a)).ok());
  const auto second = job(b);
  EXPECT_EQ(*returns(b, second, wrong_result(second, 1)), State::STATE_ASIDE);
  const auto third = job(c);
  EXPECT_EQ(*returns(c, third, wrong_result(third, 2)), State::STATE_ASIDE);
  for (const char* name : {"a", "b", "c"})
    EXPECT_EQ(state_of(name), CheckedWorker::STATE_IDLE) << name;
  EXPECT_EQ(farm_status().differing(), 2U);
  EXPECT_EQ(lease(d)->state(), schema::LeaseReply::STATE_FINISHED);
}

class StragglerTest : public FarmTest {
 protected:
  // Jobs take a second each, but for the last one, which `a` has.
  void SetUp() override {
    FarmTest::SetUp();
    submit(4);
    a_ = worker("a");
    b_ = worker("b");
    for (int i = 0; i < 3; ++i) {
      const auto quick = job(b_);
      now_s_ += 1;
      ASSERT_TRUE(complete(b_, quick).ok());
    }
    slow_ = job(a_);
  }
  void wait(double seconds) {
    now_s_ += seconds;
    ASSERT_TRUE(beat(a_, slow_.fencing_token())->lease_valid());
  }
  std::string a_, b_;
  schema::LeaseReply slow_;
};

TEST_F(StragglerTest, IsComputedTwiceAndTheFirstResultIsTaken) {
  wait(1.5);
  EXPECT_EQ(lease(b_)->state(), schema::LeaseReply::STATE_WAIT) << "not yet";
  wait(1);
  const auto second = job(b_);
  EXPECT_EQ(second.job().job_key(), slow_.job().job_key());
  EXPECT_NE(second.fencing_token(), slow_.fencing_token());
  EXPECT_EQ(lease(worker("c"))->state(), schema::LeaseReply::STATE_WAIT) << "twice is enough";
  EXPECT_EQ(*returns(b_, second), State::STATE_STORED);
  EXPECT_EQ(lease(b_)->state(), schema::LeaseReply::STATE_FINISHED);
  EXPECT_EQ(*returns(a_, slow_), State::STATE_KNOWN);
  EXPECT_EQ(status().done(), 4U);
  EXPECT_EQ(farm_status().audited(), 1U);
}

TEST_F(StragglerTest, TheSlowOneMayBeFirstAllTheSame) {
  wait(3);
  const auto second = job(b_);
  EXPECT_EQ(*returns(a_, slow_), State::STATE_STORED);
  EXPECT_EQ(*returns(b_, second), State::STATE_KNOWN);
  EXPECT_EQ(farm_status().audited(), 1U);
}

TEST_F(StragglerTest, WhenOneOfThemIsLostTheOtherGoesOn) {
  wait(3);
  auto second = job(b_);
  EXPECT_EQ(lease(worker("a"))->state(), schema::LeaseReply::STATE_LEASED) << "it waits again";
  EXPECT_EQ(*returns(b_, second), State::STATE_STORED);
  EXPECT_EQ(status().done(), 4U);
  EXPECT_EQ(status().quarantined(), 0U);
}

TEST_F(StragglerTest, AFailureOfTheSecondIsNotTheJobs) {
  wait(3);
  EXPECT_TRUE(fail(b_, job(b_), "no luck", schema::FailRequest::KIND_BAD_INPUT).ok());
  EXPECT_EQ(status().quarantined(), 0U);
  EXPECT_EQ(*returns(a_, slow_), State::STATE_STORED);
}

// The one that takes longest has been done by somebody else: the next one's turn.
TEST_F(FarmTest, BehindASettledStragglerTheNextIsComputedTwice) {
  submit(5);
  const auto a = worker("a"), b = worker("b"), c = worker("c");
  const auto slow = job(a), also_slow = job(c);
  for (int i = 0; i < 3; ++i) {
    const auto quick = job(b);
    now_s_ += 1;
    ASSERT_TRUE(complete(b, quick).ok());
  }
  now_s_ += 3;
  const auto second = job(b);
  EXPECT_EQ(second.job().job_key(), slow.job().job_key());
  EXPECT_EQ(*returns(b, second), State::STATE_STORED);
  const auto third = job(b);  // `a` still computes what is done
  EXPECT_EQ(third.job().job_key(), also_slow.job().job_key());
  EXPECT_EQ(*returns(b, third), State::STATE_STORED);
  EXPECT_EQ(status().done(), 5U);
  EXPECT_EQ(lease(b)->state(), schema::LeaseReply::STATE_FINISHED);
}

TEST_F(StragglerTest, ACancelledOneIsNotComputedTwice) {
  wait(3);
  const auto sha = status().sweep_sha256();
  ASSERT_TRUE(ask([&] { return farm_->cancel(sha); }).ok());
  EXPECT_EQ(lease(b_)->state(), schema::LeaseReply::STATE_FINISHED);
}

}  // namespace
}  // namespace irsig
