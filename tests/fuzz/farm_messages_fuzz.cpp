// Damages every message that a client may send: submissions and results as bytes and field by
// field, and every other request field by field. The coordinator answers OK or refuses; an accepted
// sweep is stored, and so is an accepted result.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>
#include <utility>

#include "coordinator/commit_loop.h"
#include "coordinator/farm.h"
#include "core/base/printable.h"
#include "jobs/check_resolved.h"
#include "jobs/text/size_bounds.h"
#include "schema/store/check/check_plausible.h"
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
  void SetUp() override { make_store(); }
  void TearDown() override { remove_store(); }

  void make_store() {
    std::string pattern = testing::TempDir() + "/irsig-fuzz-XXXXXX";
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    auto store = StoreWriter::open(folder_ + "/a.sigdb");
    ASSERT_TRUE(store.ok()) << store.status();
    store_ = *std::move(store);
  }
  void remove_store() {
    store_.reset();
    std::filesystem::remove_all(folder_);
  }

  // Submits bytes as the coordinator takes them; nothing of them stays.
  absl::Status submit(const std::string& bytes) {
    auto status = check_wire_size(bytes, *schema::ResolvedSweep::descriptor(), kMostMemory);
    if (!status.ok()) return status;
    schema::ResolvedSweep sweep;
    if (!sweep.ParseFromString(bytes)) return absl::InvalidArgumentError("damaged");
    auto made = make_submission(check_resolved, std::move(sweep), 1, {});
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
  const auto made = make_submission(check_resolved, sweep, 1, {});
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

// A farm, and who talks to it: one worker who works, and others who, like the users, say one thing
// in three wrong.
class Babel {
 public:
  Babel(StoreWriter& store, std::uint64_t seed)
      : store_(store), sweep_(heated_frigate_sweep(40)), random_(seed), fields_(seed + 1) {
    registration_.set_determinism_class(kSyntheticClass);
    registration_.set_build_id("b");
    registration_.set_physics_version(1);
    registration_.set_host("h");
    const auto made = make_submission(check_resolved, sweep_, 1, {});
    EXPECT_TRUE(made.ok()) << made.status();
    if (!made.ok()) return;
    sha256_ = made->sweep_sha256;
    serve([&] { return farm_.submit(*made).status(); });
    serve([&] { return work(); });  // before anybody can give up what he would do
  }

  void say_something() {
    now_s_ += 0.1;
    serve([&] { return random_() % 20 == 0 ? work() : babble(); });
    if (random_() % 20 == 0) serve([&] { return farm_.drop_silent_workers(); });
  }
  // Everybody else goes away.
  void work_to_the_end() {
    now_s_ += 1e4;
    for (int i = 0; i < 200; ++i) {
      serve([&] { return farm_.drop_silent_workers(); });
      serve([&] { return work(); });
      now_s_ += 5;
    }
  }

  [[nodiscard]] int answered() const { return answered_; }
  [[nodiscard]] int refused() const { return refused_; }
  [[nodiscard]] std::uint64_t stored() const { return stored_; }  // results
  [[nodiscard]] schema::SweepStatus sweep() {
    const auto status = farm_.status();
    EXPECT_TRUE(status.ok() && status->sweep_size() == 1) << status.status();
    return status.ok() && status->sweep_size() == 1 ? status->sweep(0) : schema::SweepStatus();
  }

 private:
  // One request as the commit loop serves it.
  template <class Ask>
  void serve(Ask ask) {
    EXPECT_TRUE(store_.begin().ok());
    const absl::Status status = ask();
    EXPECT_TRUE(status.ok() || is_refusal(status)) << status;
    EXPECT_TRUE(store_.commit().ok());
    ++(status.ok() ? answered_ : refused_);
  }
  template <class Request>
  Request damaged(Request request) {
    if (random_() % 3 == 0) fields_.mutate(request);
    return request;
  }

  absl::Status work() {
    schema::LeaseRequest lease;
    lease.set_worker_id(honest_id_);
    auto job = farm_.lease(lease);
    if (absl::IsNotFound(job.status())) {
      auto request = registration_;
      request.set_worker_name("honest");
      const auto reply = farm_.register_worker(request);
      if (!reply.ok()) return reply.status();
      honest_id_ = reply->worker_id();
      lease.set_worker_id(honest_id_);
      job = farm_.lease(lease);
    }
    EXPECT_TRUE(job.ok()) << job.status();
    if (!job.ok() || job->state() != schema::LeaseReply::STATE_LEASED) return job.status();
    const schema::JobResult result = synthetic_result(sweep_, job->job());
    const auto taken = farm_.complete({.worker_id = honest_id_,
                                       .fencing_token = job->fencing_token(),
                                       .sweep_sha256 = sha256_,
                                       .result = result});
    EXPECT_TRUE(taken.ok()) << taken.status();
    if (taken.ok() && taken->state() == schema::CompleteReply::STATE_STORED) ++stored_;
    return taken.status();
  }

  absl::Status babble() {
    switch (random_() % 8) {
      case 0: {
        auto request = registration_;
        request.set_worker_name("w" + std::to_string(random_() % 5));
        const auto reply = farm_.register_worker(damaged(request));
        if (reply.ok()) worker_id_ = reply->worker_id();
        return reply.status();
      }
      case 1: {
        schema::LeaseRequest request;
        request.set_worker_id(worker_id_);
        request = damaged(request);
        const auto reply = farm_.lease(request);
        if (reply.ok()) held_[request.worker_id()] = token_ = reply->fencing_token();
        return reply.status();
      }
      case 2: {
        schema::HeartbeatRequest request;
        request.set_worker_id(worker_id_);
        request.set_fencing_token(token_);
        request = damaged(request);
        const auto reply = farm_.heartbeat(request);
        if (reply.ok() && reply->lease_valid() && request.fencing_token() != 0) {
          EXPECT_EQ(request.fencing_token(), held_[request.worker_id()]);
        }
        return reply.status();
      }
      case 3: {
        schema::FailRequest request;
        request.set_worker_id(worker_id_);
        request.set_fencing_token(token_);
        request.set_message("it failed");
        request.set_kind(schema::FailRequest::KIND_OTHER);
        request = damaged(request);
        const auto status = farm_.fail(request);
        // Nobody gives up another one's lease.
        if (status.ok()) {
          EXPECT_NE(request.fencing_token(), 0U);
          EXPECT_EQ(request.fencing_token(), std::exchange(held_[request.worker_id()], 0));
        }
        return status;
      }
      case 4: {
        schema::FetchAssetRequest request;
        request.set_sha256(sha256_);
        return farm_.asset(damaged(request).sha256()).status();
      }
      case 5: {
        schema::CancelRequest request;  // of a sweep that is not there
        request.set_sweep_sha256(std::string(64, '0'));
        return farm_.cancel(damaged(request).sweep_sha256()).status();
      }
      case 6: {
        schema::PrioritizeRequest request;
        request.set_sweep_sha256(sha256_);
        request.set_priority(3);
        return farm_.prioritize(damaged(request)).status();
      }
      default: {
        const auto status = farm_.status();
        if (!status.ok()) return status.status();
        for (const schema::WorkerStatus& worker : status->worker())
          for (const auto* text : {&worker.name(), &worker.host(), &worker.determinism_class()})
            EXPECT_TRUE(is_one_line(*text) && text->size() <= kLongestName) << *text;
        EXPECT_LE(std::abs(status->sweep(0).priority()), kMostPriority);
        return absl::OkStatus();
      }
    }
  }

  StoreWriter& store_;
  schema::ResolvedSweep sweep_;
  std::mt19937_64 random_;
  fuzz::MessageMutator fields_;
  double now_s_ = 0;
  Farm farm_{store_,
             FarmRules{.audit_fraction = 0},
             [this] { return now_s_; },
             [this] { return 1e9 + now_s_; },
             "c",
             check_resolved};
  schema::RegisterRequest registration_;
  std::map<std::string, std::uint64_t> held_;  // worker id -> token
  std::string sha256_, honest_id_, worker_id_;
  std::uint64_t token_ = 0, stored_ = 0;
  int answered_ = 0, refused_ = 0;
};

// A turn is a farm, from its submission to its end.
TEST_F(FarmMessages, WhoWorksLosesNothingByTheRequestsOfOthers) {
  constexpr int kRequests = 800;  // the sweep is open to their end
  std::uint64_t all = 0, done = 0;
  fuzz::Turns turn(2);
  while (turn.next()) {
    remove_store();
    make_store();
    Babel farm(*store_, 2 * static_cast<std::uint64_t>(turn.index()) + 5);
    for (int i = 0; i < kRequests; ++i) {
      farm.say_something();
      ASSERT_FALSE(HasFailure()) << "turn " << turn.index() << ", request " << i;
    }
    EXPECT_GT(farm.answered(), kRequests / 4);
    EXPECT_GT(farm.refused(), kRequests / 10);
    farm.work_to_the_end();
    const schema::SweepStatus end = farm.sweep();
    EXPECT_EQ(end.done(), farm.stored()) << end.ShortDebugString();
    EXPECT_EQ(end.done() + end.quarantined(), end.jobs()) << end.ShortDebugString();
    all += end.jobs();
    done += end.done();
    ASSERT_FALSE(HasFailure()) << "turn " << turn.index();
  }
  // Others may give up a job that they hold, as bad input, and with it all that need it.
  EXPECT_GT(done, all / 2);
}

}  // namespace
}  // namespace irsig
