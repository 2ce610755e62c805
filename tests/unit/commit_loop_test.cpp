#include "coordinator/commit_loop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <future>
#include <memory>
#include <stdexcept>
#include <string>

#include "jobs/check_resolved.h"
#include "tests/fault/synthetic_farm.h"

namespace irsig {
namespace {

using testing::HasSubstr;

// One request fails in a way that nobody thought of: it is undone, the others are not.
TEST(CommitLoopFaults, AFailedRequestTakesNothingAlong) {
  std::string folder = testing::TempDir() + "/irsig-loop-XXXXXX";
  ASSERT_NE(mkdtemp(folder.data()), nullptr);
  auto store = StoreWriter::open(folder + "/a.sigdb").value();
  Farm farm(
      *store, FarmRules{}, [] { return 0.0; }, [] { return 1e9; }, "c", check_resolved);
  CommitLoop loop;
  bool broken = false;
  const auto ask = [&](CommitLoop::Work work) {
    auto done = std::make_shared<std::promise<absl::Status>>();
    auto answer = done->get_future();
    loop.post(CommitLoop::Kind::kWrites, std::move(work),
              [done](const absl::Status& s) { done->set_value(s); });
    return answer;
  };
  const auto submission = make_submission(check_resolved, frigate_sweep(3), 1, {});
  ASSERT_TRUE(submission.ok());
  auto submitted = ask([&](Farm& f) { return f.submit(*submission).status(); });
  auto thrown = ask([](Farm&) -> absl::Status { throw std::runtime_error("lost its way"); });
  auto failed = ask([&](Farm&) -> absl::Status {
    if (auto lost = store->lease_next("nobody", 0); !lost.ok()) return lost.status();
    return absl::InternalError("half done");
  });
  auto after = ask([](Farm& f) { return f.status().status(); });
  loop.start(farm, *store, [&](const absl::Status&) { broken = true; });
  EXPECT_TRUE(submitted.get().ok());
  EXPECT_THAT(std::string(thrown.get().message()), HasSubstr("lost its way"));
  EXPECT_TRUE(absl::IsInternal(failed.get()));
  EXPECT_TRUE(after.get().ok());
  // A lease that was kept, and that no session knows.
  auto kept = ask([&](Farm&) { return store->lease_next("nobody", 0).status(); });
  EXPECT_TRUE(kept.get().ok());
  EXPECT_TRUE(absl::IsInternal(ask([](Farm&) { return absl::InternalError("another"); }).get()));
  loop.stop();
  EXPECT_FALSE(broken);
  const auto progress = store->progress();
  ASSERT_TRUE(progress.ok());
  EXPECT_EQ(progress->front().waiting, 3U);
  EXPECT_EQ(progress->front().leased, 0U);
  store.reset();
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace irsig
