// What a client may send, against what the coordinator does with it: submissions and results,
// damaged as bytes and field by field. The answer is OK or a refusal; what is taken for a sweep is
// stored, and so is what is taken for a result.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

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

bool is_refusal(const absl::Status& status) {
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
    ASSERT_TRUE(status.ok() || is_refusal(status)) << status << "\n" << sweep.ShortDebugString();
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
      ASSERT_TRUE(status.ok() || is_refusal(status)) << status;
      ++(status.ok() ? stored : refused);
    }
    ASSERT_TRUE(store_->complete((*job)->fencing_token, good, "w").ok());
    ASSERT_TRUE(store_->commit().ok());
  }
  EXPECT_GT(stored, 50);
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace irsig
