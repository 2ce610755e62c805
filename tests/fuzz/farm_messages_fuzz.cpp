// What a client may send, against what the coordinator does with it: submissions and results,
// damaged as bytes and field by field, and every other request, field by field. The answer is OK or
// a refusal; what is taken for a sweep is stored, and so is what is taken for a result.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <random>

#include "coordinator/commit_loop.h"
#include "coordinator/farm.h"
#include "schema/store/check_plausible.h"
#include "schema/wire_size.h"
#include "tests/fault/synthetic_farm.h"
#include "tests/fuzz/message_mutator.h"
#include "tests/fuzz/mutator.h"
#include "tests/fuzz/turns.h"

namespace irsig {
namespace {

constexpr std::uint64_t kMostMemory = 64 << 20;
constexpr const char* kWords[] = {"\xff\xff\xff\xff\x0f", "\x0a\x7f", "nan", "\x00\x00"};

bool is_refused_input(const absl::Status& status) {
  return absl::IsInvalidArgument(status) || absl::IsResourceExhausted(status);
}

class FarmMessages : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "/irsig-fuzz-XXXXXX";
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    auto store = StoreWriter::open(folder_ + "/a.sigdb");
    ASSERT_TRUE(store.ok()) << store.status();
    store_ = *std::move(store);
  }
  void TearDown() override {
    store_.reset();
    std::filesystem::remove_all(folder_);
  }

  // As the coordinator takes it; nothing of it stays.
  absl::Status submit(const std::string& bytes) {
    auto status = check_wire_size(bytes, *schema::ResolvedSweep::descriptor(), kMostMemory);
    if (!status.ok()) return status;
    schema::ResolvedSweep sweep;
    if (!sweep.ParseFromString(bytes)) return absl::InvalidArgumentError("damaged");
    auto made = make_submission(std::move(sweep), 1, {});
    if (!made.ok()) return made.status();
    EXPECT_TRUE(store_->begin().ok());
    status = store_->add_sweep(made->sweep, made->sweep_sha256, made->jobs, made->assets).status();
    store_->rollback();
    return status;
  }

  std::string folder_;
  std::unique_ptr<StoreWriter> store_;
};

TEST_F(FarmMessages, EverySubmissionIsStoredOrRefused) {
  const schema::ResolvedSweep sweeps[] = {frigate_sweep(4), heated_frigate_sweep(3)};
  fuzz::MessageMutator fields(1);
  fuzz::Mutator bytes(2, kWords);
  int stored = 0, refused = 0;
  fuzz::Turns turn(1500);
  while (turn.next()) {
    schema::ResolvedSweep sweep = sweeps[turn.index() % 2];
    std::string text;
    if (turn.index() % 3 == 0) {
      text = bytes.mutate(sweep.SerializeAsString());
    } else {
      fields.mutate(sweep);
      text = sweep.SerializeAsString();
    }
    const absl::Status status = submit(text);
    ASSERT_TRUE(status.ok() || is_refused_input(status)) << status << "\n"
                                                         << sweep.ShortDebugString();
    ++(status.ok() ? stored : refused);
  }
  EXPECT_GT(stored, turn.done() / 20);
  EXPECT_GT(refused, turn.done() / 4);
}

TEST_F(FarmMessages, EveryResultIsStoredOrRefused) {
  const schema::ResolvedSweep sweep = heated_frigate_sweep(2);
  const auto made = make_submission(sweep, 1, {});
  ASSERT_TRUE(made.ok()) << made.status();
  ASSERT_TRUE(store_->begin().ok());
  ASSERT_TRUE(store_->add_sweep(made->sweep, made->sweep_sha256, made->jobs, {}).ok());
  ASSERT_TRUE(store_->commit().ok());
  fuzz::MessageMutator fields(3);
  fuzz::Mutator bytes(4, kWords, 400);
  int stored = 0, refused = 0;
  // First the heat jobs, then views.
  const std::size_t jobs = made->jobs.size() / 2 + 1;
  for (std::size_t job_index = 0; job_index < jobs; ++job_index) {
    ASSERT_TRUE(store_->begin().ok());
    const auto job = store_->lease_next("w", 0);
    ASSERT_TRUE(job.ok() && job->has_value());
    const schema::JobResult good = synthetic_result(sweep, (*job)->spec);
    ASSERT_TRUE(check_plausible(good).ok()) << check_plausible(good);
    for (fuzz::Turns turn(150, 1.0 / static_cast<double>(jobs)); turn.next();) {
      schema::JobResult result = good;
      std::string text;
      if (turn.index() % 3 == 0) {
        text = bytes.mutate(result.SerializeAsString());
      } else {
        fields.mutate(result);
        text = result.SerializeAsString();
      }
      absl::Status status = check_wire_size(text, *schema::JobResult::descriptor(), kMostMemory);
      schema::JobResult received;
      if (status.ok() && !received.ParseFromString(text))
        status = absl::InvalidArgumentError("damaged");
      if (status.ok()) status = check_plausible(received);
      if (status.ok()) {
        ASSERT_TRUE(store_->begin_request().ok());
        status = store_->complete((*job)->fencing_token, received, "w");
        ASSERT_TRUE(store_->undo_request().ok());
      }
      ASSERT_TRUE(status.ok() || is_refused_input(status)) << status;
      ++(status.ok() ? stored : refused);
    }
    ASSERT_TRUE(store_->complete((*job)->fencing_token, good, "w").ok());
    ASSERT_TRUE(store_->commit().ok());
  }
  EXPECT_GT(stored, 50);
  EXPECT_GT(refused, 100);
}

// Requests without a stream, from workers and users who say one thing in three wrong, between those
// of a worker who works: he loses nothing by them but what they cancel or give up in their own
// name.
TEST_F(FarmMessages, EveryRequestIsAnsweredOrRefused) {
  const schema::ResolvedSweep sweep = heated_frigate_sweep(40);
  double now_s = 0;
  FarmRules rules;
  rules.audit_share = 0;
  Farm farm(
      *store_, rules, [&] { return now_s; }, [&] { return 1e9 + now_s; }, "c");
  auto made = make_submission(sweep, 1, {});
  ASSERT_TRUE(made.ok()) << made.status();
  ASSERT_TRUE(store_->begin().ok());
  ASSERT_TRUE(farm.submit(*made).ok());
  ASSERT_TRUE(store_->commit().ok());

  fuzz::MessageMutator fields(5);
  std::mt19937_64 random(6);
  schema::RegisterRequest registration;
  registration.set_worker_name("w");
  registration.set_determinism_class(kSyntheticClass);
  registration.set_build_id("b");
  registration.set_physics_version(1);
  registration.set_host("h");
  std::string worker_id, honest_id;
  std::uint64_t token = 0;
  int answered = 0, refused = 0;

  // One request as the commit loop serves it.
  const auto serve = [&](auto ask) {
    EXPECT_TRUE(store_->begin().ok());
    const absl::Status status = ask();
    EXPECT_TRUE(status.ok() || is_refusal(status)) << status;
    EXPECT_TRUE(store_->commit().ok());
    ++(status.ok() ? answered : refused);
  };
  const auto damaged = [&](auto request) {
    if (random() % 3 == 0) fields.mutate(request);
    return request;
  };
  const auto honest_step = [&] {
    auto request = registration;
    request.set_worker_name("honest");
    schema::LeaseRequest lease;
    lease.set_worker_id(honest_id);
    auto job = farm.lease(lease);
    if (absl::IsNotFound(job.status())) {
      auto reply = farm.register_worker(request);
      if (!reply.ok()) return reply.status();
      honest_id = reply->worker_id();
      lease.set_worker_id(honest_id);
      job = farm.lease(lease);
    }
    if (!job.ok() || job->state() != schema::LeaseReply::STATE_LEASED) return job.status();
    const schema::JobResult result = synthetic_result(sweep, job->job());
    const auto taken = farm.complete({.worker_id = honest_id,
                                      .fencing_token = job->fencing_token(),
                                      .sweep_sha256 = job->job().sweep_sha256(),
                                      .result = result});
    EXPECT_TRUE(taken.ok()) << taken.status();
    return taken.status();
  };
  fuzz::Turns turn(1500);
  while (turn.next()) {
    now_s += 0.3;
    serve([&]() -> absl::Status {
      switch (random() % 8) {
        case 0: {
          auto request = registration;
          request.set_worker_name("w" + std::to_string(random() % 5));
          const auto reply = farm.register_worker(damaged(request));
          if (reply.ok()) worker_id = reply->worker_id();
          return reply.status();
        }
        case 1: {
          schema::LeaseRequest request;
          request.set_worker_id(worker_id);
          const auto reply = farm.lease(damaged(request));
          if (reply.ok()) token = reply->fencing_token();
          return reply.status();
        }
        case 2: {
          schema::HeartbeatRequest request;
          request.set_worker_id(worker_id);
          request.set_fencing_token(token);
          return farm.heartbeat(damaged(request)).status();
        }
        case 3: {
          schema::FailRequest request;
          request.set_worker_id(worker_id);
          request.set_fencing_token(token);
          request.set_message("it failed");
          request.set_kind(schema::FailRequest::KIND_OTHER);
          return farm.fail(damaged(request));
        }
        case 4: {
          schema::FetchAssetRequest request;
          request.set_sha256(made->sweep_sha256);
          return farm.asset(damaged(request).sha256()).status();
        }
        case 5: {
          schema::CancelRequest request;
          request.set_sweep_sha256(std::string(64, '0'));
          return farm.cancel(damaged(request).sweep_sha256()).status();
        }
        case 6: {
          schema::PrioritizeRequest request;
          request.set_sweep_sha256(made->sweep_sha256);
          request.set_priority(3);
          return farm.prioritize(damaged(request)).status();
        }
        default:
          return turn.index() % 5 == 0 ? honest_step() : farm.status().status();
      }
    });
    if (turn.index() % 20 == 0) serve([&] { return farm.drop_silent_workers(); });
    ASSERT_FALSE(HasFailure()) << "turn " << turn.index();
  }
  EXPECT_GT(answered, turn.done() / 4);
  EXPECT_GT(refused, turn.done() / 20);
  // Everybody else goes away; what was not given up in the sweep is done by whoever works.
  now_s += 1e4;
  for (int i = 0; i < 200; ++i) {
    if (i % 2 == 0) serve([&] { return farm.drop_silent_workers(); });
    serve(honest_step);
    now_s += 5;
  }
  const auto status = farm.status();
  ASSERT_TRUE(status.ok()) << status.status();
  ASSERT_EQ(status->sweep_size(), 1);
  const auto& end = status->sweep(0);
  EXPECT_EQ(end.done() + end.quarantined() + end.cancelled(), end.jobs()) << end.ShortDebugString();
  EXPECT_GT(end.done(), 0U);
  EXPECT_EQ(end.cancelled(), 0U);
}

}  // namespace
}  // namespace irsig
