#pragma once

// A farm on a real store, without threads or sockets, with a clock that the test sets.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include "coordinator/farm.h"
#include "jobs/check_resolved.h"
#include "tests/fault/synthetic_farm.h"

namespace irsig {

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
        *store_, rules_, [this] { return now_s_; }, [this] { return unix_s_; }, coordinator_id,
        check_resolved);
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
    auto submission = make_submission(check_resolved, sweep_, 1, {});
    ASSERT_TRUE(submission.ok());
    const auto reply = ask([&] { return farm_->submit(*submission); });
    ASSERT_TRUE(reply.ok()) << reply.status();
  }

  absl::StatusOr<schema::RegisterReply> try_worker(const std::string& name,
                                                   const std::string& klass = kSyntheticClass,
                                                   std::uint32_t physics_version = 1,
                                                   std::uint64_t memory_bytes = 0) {
    schema::RegisterRequest request;
    request.set_worker_name(name);
    request.set_determinism_class(klass);
    request.set_physics_version(physics_version);
    request.set_memory_bytes(memory_bytes);
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

  absl::StatusOr<schema::CompleteReply::State> returns(const std::string& worker_id,
                                                       const schema::LeaseReply& lease,
                                                       const schema::JobResult& result) {
    const auto reply = ask([&] {
      return farm_->complete({.worker_id = worker_id,
                              .fencing_token = lease.fencing_token(),
                              .sweep_sha256 = lease.job().sweep_sha256(),
                              .result = result});
    });
    if (!reply.ok()) return reply.status();
    return reply->state();
  }
  absl::StatusOr<schema::CompleteReply::State> returns(const std::string& worker_id,
                                                       const schema::LeaseReply& lease) {
    return returns(worker_id, lease, synthetic_result(sweep_, lease.job()));
  }
  // Another result than everybody else's.
  schema::JobResult wrong_result(const schema::LeaseReply& lease, double by = 1) {
    auto result = synthetic_result(sweep_, lease.job());
    auto& row = *result.mutable_view()->mutable_row(0);
    row.set_sun_azimuth_deg(row.sun_azimuth_deg() / 2 + by);
    return result;
  }
  absl::Status complete(const std::string& worker_id, const schema::LeaseReply& lease) {
    return returns(worker_id, lease).status();
  }
  absl::Status fail(const std::string& worker_id, const schema::LeaseReply& lease,
                    const std::string& message,
                    schema::FailRequest::Kind kind = schema::FailRequest::KIND_OTHER) {
    schema::FailRequest request;
    request.set_kind(kind);
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
  schema::StatusReply farm_status() {
    const auto reply = farm_->status();
    EXPECT_TRUE(reply.ok()) << reply.status();
    return reply.value_or(schema::StatusReply());
  }
  schema::SweepStatus status() {
    const auto reply = farm_->status();
    EXPECT_TRUE(reply.ok() && reply->sweep_size() == 1);
    return reply->sweep(0);
  }

  std::string folder_;
  double now_s_ = 1000, unix_s_ = 1.7e9;
  FarmRules rules_{
      .heartbeat_s = 2, .lost_after_s = 10, .tolerated_losses = 5, .audit_fraction = 0};
  std::unique_ptr<StoreWriter> store_;
  std::unique_ptr<Farm> farm_;
  schema::ResolvedSweep sweep_;
};

}  // namespace irsig
