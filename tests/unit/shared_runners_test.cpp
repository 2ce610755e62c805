// Loops of one process that compute one sweep have one runner; it goes with the last of them.
#include "worker/shared_runners.h"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

namespace irsig {
namespace {

class NoRunner final : public JobRunner {
 public:
  absl::StatusOr<schema::JobResult> run(const schema::JobSpec&) const override {
    return schema::JobResult();
  }
};

struct Maker {
  std::atomic<int> made = 0;
  SharedRunners::Make make = [this](Assets& assets) {
    assets["asset"] = "bytes";
    ++made;
    return absl::StatusOr<std::unique_ptr<const JobRunner>>(std::make_unique<NoRunner>());
  };
};

TEST(SharedRunners, LoopsOfOneSweepHaveOne) {
  SharedRunners runners;
  Maker maker;
  std::vector<std::shared_ptr<const JobRunner>> got(8);
  std::vector<std::thread> loops;
  for (auto& one : got)
    loops.emplace_back([&] { one = *runners.get({"sweep", {"heat"}}, maker.make); });
  for (std::thread& loop : loops) loop.join();
  EXPECT_EQ(maker.made, 1);
  for (const auto& one : got) EXPECT_EQ(one, got.front());
}

TEST(SharedRunners, ItGoesWithTheLastLoop) {
  SharedRunners runners;
  Maker maker;
  auto first = *runners.get({"sweep", {}}, maker.make);
  const std::weak_ptr<const JobRunner> watched = first;
  first.reset();
  EXPECT_TRUE(watched.expired());
  first = *runners.get({"sweep", {}}, maker.make);
  EXPECT_EQ(maker.made, 2);
}

TEST(SharedRunners, AnotherSweepAndOtherTemperaturesHaveTheirOwn) {
  SharedRunners runners;
  Maker maker;
  const auto before = *runners.get({"sweep", {}}, maker.make);
  const auto after = *runners.get({"sweep", {"heat"}}, maker.make);
  const auto other = *runners.get({"other", {"heat"}}, maker.make);
  EXPECT_EQ(maker.made, 3);
  EXPECT_NE(before, after);
  EXPECT_NE(after, other);
  // Jobs that need no temperatures take what is there.
  EXPECT_EQ(*runners.get({"sweep", {}}, maker.make), before);
  EXPECT_EQ(*runners.get({"sweep", {"heat"}}, maker.make), after);
  EXPECT_EQ(maker.made, 3);
}

TEST(SharedRunners, AfterAFailureTheNextIsNew) {
  SharedRunners runners;
  Maker maker;
  const auto first = *runners.get({"sweep", {}}, maker.make);
  runners.forget(first);
  EXPECT_NE(*runners.get({"sweep", {}}, maker.make), first);
  EXPECT_EQ(maker.made, 2);
  // A runner that cannot be made is nobody's, and asked for again.
  const auto refused = runners.get(
      {"bad", {}}, [](Assets&) { return absl::InvalidArgumentError("no group \"funel\""); });
  EXPECT_TRUE(absl::IsInvalidArgument(refused.status()));
  EXPECT_TRUE(runners.get({"bad", {}}, maker.make).ok());
}

}  // namespace
}  // namespace irsig
