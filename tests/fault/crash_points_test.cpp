// A coordinator killed at each call that leaves a mark: before and after each fsync and each reply,
// before each write. What it had acknowledged is there when another one starts, and the end is that
// of a calm run.
//
// IRSIG_CRASH_POINTS: how many of each kind are tried, drawn with a fixed seed; "all" for every
// one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <random>
#include <thread>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "coordinator/client/child_process.h"
#include "coordinator/client/farm_client.h"
#include "schema/store/reader.h"
#include "tests/fault/synthetic_farm.h"

namespace irsig {
namespace {

constexpr std::size_t kPoints = 8;  // of each kind
constexpr std::uint32_t kViews = 3;
constexpr const char* kKinds[] = {"sync", "write", "send"};  // as die_at_call.cpp counts them

template <class Fact>
bool wait_for(Fact fact) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(120);
  while (!fact()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

class CrashPoints : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = "/tmp/irsig-crash-XXXXXX";
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    root_ = pattern;
    address_ = *parse_address("unix:" + root_ + "/farm");
  }
  void TearDown() override { std::filesystem::remove_all(root_); }

  [[nodiscard]] std::string path(const std::string& name) const { return root_ + "/" + name; }

  // die_at: as die_at_call.cpp has it; empty: its calls are counted only.
  ChildProcess coordinator(const std::string& die_at) {
    std::vector<std::string> command = {"/usr/bin/env", "LD_PRELOAD=" IRSIG_DIE_AT_CALL,
                                        // AddressSanitizer wants to be the first of all libraries.
                                        "ASAN_OPTIONS=verify_asan_link_order=0",
                                        "IRSIG_TEST_CALLS=" + path("calls")};
    if (!die_at.empty()) command.push_back("IRSIG_TEST_DIE_AT=" + die_at);
    command.insert(command.end(), {IRSIG_COORDINATOR, "--db", path("out.sigdb"), "--listen",
                                   address_.text, "--audit-share", "0"});
    auto child = ChildProcess::start(command, path("coordinator.log"), SIGKILL);
    EXPECT_TRUE(child.ok()) << child.status();
    return *std::move(child);
  }
  ChildProcess worker() {
    auto child =
        ChildProcess::start({IRSIG_SYNTHETIC_WORKER, "--coordinator", address_.text, "--name", "a",
                             "--exit-when-finished", "--spool", path("spool")},
                            path("worker.log"), SIGKILL);
    EXPECT_TRUE(child.ok()) << child.status();
    return *std::move(child);
  }

  [[nodiscard]] std::map<std::string, std::uint64_t> calls() const {
    std::ifstream in(path("calls"), std::ios::binary);
    std::map<std::string, std::uint64_t> out;
    for (const char* kind : kKinds) {
      std::uint64_t number = 0;
      in.read(reinterpret_cast<char*>(&number), sizeof number);
      out[kind] = number;
    }
    return out;
  }

  std::string digest() {
    const auto reader = StoreReader::open(path("out.sigdb"));
    EXPECT_TRUE(reader.ok()) << reader.status();
    return reader.ok() ? (*reader)->digest().value_or("none") : "";
  }

  // Until it is acknowledged, or the coordinator has ended.
  bool submits(ChildProcess& to) {
    while (!to.ended()) {
      if (farm_status(address_, 5).ok() &&
          submit(address_, sweep_, {}, 1, nullptr, std::nullopt, 5).ok())
        return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }

  // A sweep from its submission to the end of the coordinator, which is killed meanwhile. False: it
  // ended before that call.
  bool killed_and_finished(const std::string& die_at) {
    for (const char* left :
         {"out.sigdb", "out.sigdb-wal", "out.sigdb-shm", "out.sigdb-lock", "farm", "calls"})
      std::filesystem::remove(path(left));
    std::filesystem::remove_all(path("spool"));
    auto fatal = coordinator(die_at);
    const bool acknowledged = submits(fatal);
    auto one = worker();
    EXPECT_TRUE(wait_for([&] { return one.ended() || fatal.ended(); }));
    const bool all_acknowledged = one.ended().has_value();
    if (all_acknowledged) fatal.signal(SIGTERM);
    EXPECT_TRUE(wait_for([&] { return fatal.ended().has_value(); }));
    const bool killed = fatal.ended() == "killed by signal 9";
    EXPECT_TRUE(killed || fatal.succeeded()) << fatal.last_words();

    auto next = coordinator("");
    std::optional<schema::StatusReply> told;
    EXPECT_TRUE(wait_for([&] {
      if (auto status = farm_status(address_, 5); status.ok()) told = *std::move(status);
      return told || next.ended();
    }));
    if (!told) {
      ADD_FAILURE() << next.last_words();
      return killed;
    }
    if (acknowledged) {
      EXPECT_EQ(told->sweep_size(), 1) << "an acknowledged sweep is lost";
    } else {
      EXPECT_TRUE(submits(next)) << next.last_words();
    }
    if (all_acknowledged) {
      EXPECT_EQ(told->sweep(0).done(), kViews) << "an acknowledged result is lost";
    }
    EXPECT_TRUE(one.wait(120)) << one.last_words();
    EXPECT_TRUE(one.succeeded()) << one.last_words();
    const auto ended = farm_status(address_);
    EXPECT_TRUE(ended.ok()) << ended.status();
    if (ended.ok()) {
      EXPECT_EQ(ended->sweep(0).done(), kViews);
      EXPECT_EQ(ended->differing(), 0U);
    }
    next.signal(SIGTERM);
    EXPECT_TRUE(next.wait(60));
    EXPECT_TRUE(next.succeeded()) << next.last_words();
    EXPECT_TRUE(std::filesystem::is_empty(path("spool"))) << "a result that waits";
    EXPECT_FALSE(std::filesystem::exists(path("out.sigdb-wal")));
    return killed;
  }

  std::string root_;
  Address address_;
  schema::ResolvedSweep sweep_ = frigate_sweep(kViews);
};

TEST_F(CrashPoints, WhatWasAcknowledgedIsThereAndTheEndIsThatOfACalmRun) {
  std::map<std::string, std::uint64_t> made;
  {
    auto calm = coordinator("");
    ASSERT_TRUE(submits(calm)) << calm.last_words();
    auto one = worker();
    ASSERT_TRUE(one.wait(60)) << one.last_words();
    calm.signal(SIGTERM);
    ASSERT_TRUE(calm.wait(60));
    ASSERT_TRUE(calm.succeeded()) << calm.last_words();
    made = calls();
  }
  const std::string calm = digest();
  std::size_t wanted = kPoints, all = 0;
  if (const char* asked = std::getenv("IRSIG_CRASH_POINTS")) {
    if (asked == std::string("all")) {
      wanted = std::numeric_limits<std::size_t>::max();
    } else {
      ASSERT_TRUE(absl::SimpleAtoi(asked, &wanted)) << asked;
    }
  }
  std::mt19937 random(1);
  std::vector<std::string> points;
  for (const char* kind : kKinds) {
    ASSERT_GE(made[kind], 8U) << kind << ": the calls are not seen";
    std::vector<std::string> of_kind;
    for (std::uint64_t n = 1; n <= made[kind]; ++n) {
      of_kind.push_back(absl::StrCat(kind, ":", n));
      // After a write is before the next one.
      if (kind != std::string("write")) of_kind.push_back(absl::StrCat(kind, ":", n, ":after"));
    }
    all += of_kind.size();
    std::shuffle(of_kind.begin(), of_kind.end(), random);
    of_kind.resize(std::min(of_kind.size(), wanted));
    points.insert(points.end(), of_kind.begin(), of_kind.end());
  }
  std::map<std::string, int> killed;
  for (const std::string& point : points) {
    SCOPED_TRACE(point);
    // The number of replies depends on the moment: one that did not come is no point.
    killed[point.substr(0, point.find(':'))] += killed_and_finished(point) ? 1 : 0;
    ASSERT_EQ(digest(), calm);
    ASSERT_FALSE(HasFailure());
  }
  int in_all = 0;
  for (const auto& [kind, number] : killed) in_all += number;
  std::printf("%zu of %zu points: %d kills (%d at syncs, %d at writes, %d at replies)\n",
              points.size(), all, in_all, killed["sync"], killed["write"], killed["send"]);
  EXPECT_GE(in_all * 10, static_cast<int>(points.size()) * 8);
}

}  // namespace
}  // namespace irsig
