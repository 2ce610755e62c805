// Results that wait for their coordinator: files that are torn, locked, too many; workers that are
// killed between every two steps, and coordinators that are away meanwhile.
#include "worker/spool.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <thread>

#include "absl/strings/str_cat.h"
#include "coordinator/client/child_process.h"
#include "coordinator/client/farm_client.h"
#include "jobs/keys/expand.h"
#include "schema/store/reader.h"
#include "tests/fault/synthetic_farm.h"

namespace irsig {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using Step = Spool::Step;

constexpr Step kSteps[] = {Step::kCreated, Step::kWritten, Step::kSynced,   Step::kNamed,
                           Step::kKept,    Step::kRemoved, Step::kForgotten};

const auto kEvery = [](const schema::SpooledResult&) { return true; };

schema::SpooledResult record(const std::string& key, std::size_t bytes = 1000) {
  schema::SpooledResult out;
  out.set_sweep_sha256("a sweep");
  out.set_job_key(key);
  out.set_determinism_class(kSyntheticClass);
  out.set_physics_version(1);
  out.set_result(std::string(bytes, key[0]));
  return out;
}

class SpoolTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = "/tmp/irsig-spool-XXXXXX";
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    root_ = pattern;
    folder_ = root_ + "/spool";
  }
  void TearDown() override { fs::remove_all(root_); }

  std::unique_ptr<Spool> open(Spool::AtStep at_step = {}, std::uint64_t most_bytes = 1'000'000) {
    auto spool = Spool::open(folder_, most_bytes, std::move(at_step));
    EXPECT_TRUE(spool.ok()) << spool.status();
    return spool.ok() ? *std::move(spool) : nullptr;
  }
  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> out;
    for (const auto& entry : fs::directory_iterator(folder_)) out.push_back(entry.path());
    return out;
  }

  std::string root_, folder_;
};

TEST_F(SpoolTest, WhatIsKeptIsFoundByTheNextWhenItsOwnerIsGone) {
  auto first = open();
  ASSERT_TRUE(first->keep(record("x")).ok());
  auto second = open();
  EXPECT_TRUE(second->take_over(kEvery).empty()) << "it belongs to somebody";
  first.reset();
  EXPECT_TRUE(second->take_over([](const auto& r) { return r.physics_version() == 2; }).empty());
  const auto found = second->take_over(kEvery);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].record.SerializeAsString(), record("x").SerializeAsString());
  EXPECT_TRUE(second->take_over(kEvery).empty()) << "once";
  EXPECT_TRUE(open()->take_over(kEvery).empty()) << "it belongs to the second now";
  second->remove(found[0].name);
  EXPECT_TRUE(files().empty());
}

// A record cut at every length, and with every byte changed: whole or nothing.
TEST_F(SpoolTest, ATornRecordIsNone) {
  ASSERT_TRUE(open()->keep(record("x", 100)).ok());
  const std::string path = files().at(0);
  std::ifstream in(path, std::ios::binary);
  const std::string whole(std::istreambuf_iterator<char>(in), {});
  const auto put = [&](const std::string& bytes) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
  };
  for (std::size_t length = 0; length < whole.size(); ++length) {
    put(whole.substr(0, length));
    ASSERT_TRUE(open()->take_over(kEvery).empty()) << length;
    ASSERT_TRUE(files().empty()) << "it is removed: " << length;
  }
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    put(bytes);
    ASSERT_TRUE(open()->take_over(kEvery).empty()) << at;
  }
  put(whole + "x");
  EXPECT_TRUE(open()->take_over(kEvery).empty());
  put(whole);
  EXPECT_EQ(open()->take_over(kEvery).size(), 1U);
}

TEST_F(SpoolTest, TheOldestThatBelongToNobodyMakeRoom) {
  ASSERT_TRUE(open({}, 5000)->keep(record("a", 2000)).ok());
  auto holder = open({}, 5000);
  ASSERT_EQ(holder->take_over(kEvery).size(), 1U);
  std::this_thread::sleep_for(milliseconds(20));
  ASSERT_TRUE(open({}, 5000)->keep(record("b", 2000)).ok());
  auto third = open({}, 5000);
  ASSERT_TRUE(third->keep(record("c", 2000)).ok());
  EXPECT_TRUE(absl::IsResourceExhausted(third->keep(record("d", 4000)).status()))
      << "what somebody holds stays";
  EXPECT_EQ(files().size(), 2U);
  holder.reset();
  third.reset();
  std::vector<std::string> keys;
  for (const auto& found : open()->take_over(kEvery)) keys.push_back(found.record.job_key());
  EXPECT_THAT(keys, testing::UnorderedElementsAre("a", "c"));
}

// A folder in which somebody has other files too: none of them is touched, whatever it is called.
TEST_F(SpoolTest, OtherFilesAreNotLookedAt) {
  ASSERT_NE(open(), nullptr);
  const std::string digits(32, 'a');
  const std::vector<std::string> names = {"archive.tar",
                                          "measurement.result",
                                          "notes.new-draft.txt",
                                          digits + ".new-",
                                          digits + ".new-12x",
                                          digits.substr(1) + ".result",
                                          digits + "b.result",
                                          std::string(32, 'A') + ".result",
                                          digits + ".result.old",
                                          digits + ".results",
                                          ".result",
                                          digits};
  for (const std::string& name : names)
    std::ofstream(folder_ + "/" + name) << std::string(3000, 'x');
  fs::create_directory(folder_ + "/a.result");
  auto spool = open({}, 5000);
  EXPECT_TRUE(spool->take_over(kEvery).empty());
  // Nor do they count: there is room.
  EXPECT_TRUE(spool->keep(record("k", 2000)).ok());
  for (const std::string& name : names)
    EXPECT_EQ(fs::file_size(folder_ + "/" + name), 3000U) << name;
  EXPECT_EQ(files().size(), names.size() + 2);
}

TEST_F(SpoolTest, AFolderThatOthersMayWriteToIsRefused) {
  ASSERT_EQ(mkdir(folder_.c_str(), 0700), 0);
  ASSERT_EQ(chmod(folder_.c_str(), 0777), 0);
  EXPECT_TRUE(absl::IsInvalidArgument(Spool::open(folder_).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(Spool::open(root_ + "/no/folder").status()));
  std::ofstream(root_ + "/file") << "x";
  EXPECT_TRUE(absl::IsInvalidArgument(Spool::open(root_ + "/file").status()));
  // Only regular files are read.
  ASSERT_EQ(chmod(folder_.c_str(), 0700), 0);
  ASSERT_EQ(mkfifo((folder_ + "/x.result").c_str(), 0600), 0);
  ASSERT_EQ(symlink("/etc/passwd", (folder_ + "/y.result").c_str()), 0);
  EXPECT_TRUE(open()->take_over(kEvery).empty());
}

TEST_F(SpoolTest, AProcessThatIsKilledBetweenAnyTwoStepsLeavesAllOrNothing) {
  for (const Step fatal : kSteps) {
    SCOPED_TRACE(static_cast<int>(fatal));
    fs::remove_all(folder_);
    const pid_t child = fork();
    if (child == 0) {
      auto spool = Spool::open(folder_, 1'000'000, [&](Step step) {
        if (step == fatal) raise(SIGKILL);
      });
      const auto name = (*spool)->keep(record("x"));
      (*spool)->remove(*name);
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
    const bool there = fatal == Step::kNamed || fatal == Step::kKept;
    const auto found = open()->take_over(kEvery);
    EXPECT_EQ(found.size(), there ? 1U : 0U);
    EXPECT_EQ(files().size(), there ? 1U : 0U) << "nothing half written stays";
  }
}

// The whole way: a coordinator that is killed while a worker computes, a worker that is killed at a
// step of its spool, and then another coordinator and another worker. The first two jobs are done
// before; whether the third has to be computed again is told by a worker that takes a minute for
// it.
TEST_F(SpoolTest, AWorkerKilledAtAnyStepLosesNoResult) {
  const auto sweep = frigate_sweep(3);
  const auto address = *parse_address("unix:" + root_ + "/farm");
  const auto coordinator = [&](const std::string& db) {
    auto child = ChildProcess::start({IRSIG_COORDINATOR, "--db", root_ + "/" + db, "--listen",
                                      address.text, "--audit-share", "0"},
                                     root_ + "/coordinator.log", SIGKILL);
    EXPECT_TRUE(child.ok()) << child.status();
    while (!farm_status(address, 1).ok()) std::this_thread::sleep_for(milliseconds(10));
    return *std::move(child);
  };
  const auto worker = [&](const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> arguments = {
        IRSIG_SYNTHETIC_WORKER, "--coordinator", address.text, "--name", name,
        "--exit-when-finished"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    auto child = ChildProcess::start(arguments, root_ + "/" + name + ".log", SIGKILL);
    EXPECT_TRUE(child.ok()) << child.status();
    return *std::move(child);
  };
  const auto digest = [&](const std::string& db) {
    const auto reader = StoreReader::open(root_ + "/" + db);
    EXPECT_TRUE(reader.ok()) << reader.status();
    return reader.ok() ? (*reader)->digest().value_or("none") : "";
  };
  {
    const auto running = coordinator("calm.sigdb");
    ASSERT_TRUE(submit(address, sweep, {}, 1).ok());
    EXPECT_TRUE(worker("calm", {}).wait(60));
  }
  const std::string calm = digest("calm.sigdb");
  for (const Step fatal : kSteps) {
    SCOPED_TRACE(static_cast<int>(fatal));
    const std::string db = absl::StrCat("step", static_cast<int>(fatal), ".sigdb");
    const bool after_delivery = fatal == Step::kRemoved || fatal == Step::kForgotten;
    fs::remove_all(folder_);
    auto first = coordinator(db);
    ASSERT_TRUE(submit(address, sweep, {}, 1).ok());
    auto fatal_worker =
        worker("fatal", {"--seconds", "0.5", "--spool", folder_, "--die-at-spool-step",
                         std::to_string(static_cast<int>(fatal))});
    const auto computes_the_third = [&] {
      const auto status = farm_status(address, 2);
      return status.ok() && status->sweep_size() == 1 && status->sweep(0).done() == 2 &&
             status->sweep(0).leased() == 1;
    };
    while (!computes_the_third()) std::this_thread::sleep_for(milliseconds(5));
    first.signal(SIGKILL);
    first.wait(10);
    auto second = [&]() -> std::optional<ChildProcess> {
      if (after_delivery) return coordinator(db);  // it is there again, and takes the result
      return std::nullopt;
    }();
    for (int i = 0; i < 3000 && !fatal_worker.ended(); ++i)
      std::this_thread::sleep_for(milliseconds(10));
    ASSERT_EQ(fatal_worker.ended(), "killed by signal 9") << fatal_worker.last_words();
    if (!second) second = coordinator(db);
    const bool on_disk = fatal == Step::kNamed || fatal == Step::kKept;
    const auto begun = std::chrono::steady_clock::now();
    auto next =
        worker("next", {"--seconds", on_disk || after_delivery ? "60" : "0", "--spool", folder_});
    EXPECT_TRUE(next.wait(30)) << "it had to compute again";
    EXPECT_TRUE(next.succeeded()) << next.last_words();
    RecordProperty(
        "seconds",
        std::to_string(
            std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count()));
    const auto ended = farm_status(address);
    ASSERT_TRUE(ended.ok()) << ended.status();
    EXPECT_EQ(ended->sweep(0).done(), 3U);
    EXPECT_EQ(ended->differing(), 0U);
    EXPECT_TRUE(files().empty());
    second->signal(SIGTERM);
    EXPECT_TRUE(second->wait(20));
    EXPECT_EQ(digest(db), calm);
  }
}

// The result belongs to another coordinator, which is still away: it waits.
TEST_F(SpoolTest, AResultOfASweepThatACoordinatorDoesNotHaveIsKept) {
  const auto address = *parse_address("unix:" + root_ + "/farm");
  ASSERT_TRUE(open()->keep(record("x")).ok());
  {
    auto result = record("y");
    result.set_result(synthetic_result(frigate_sweep(1), expand_jobs(frigate_sweep(1), 1).front())
                          .SerializeAsString());
    ASSERT_TRUE(open()->keep(result).ok());
  }
  auto coordinator = ChildProcess::start(
      {IRSIG_COORDINATOR, "--db", root_ + "/other.sigdb", "--listen", address.text},
      root_ + "/coordinator.log", SIGKILL);
  ASSERT_TRUE(coordinator.ok());
  while (!farm_status(address, 1).ok()) std::this_thread::sleep_for(milliseconds(10));
  ASSERT_TRUE(submit(address, frigate_sweep(1, "another"), {}, 1).ok());
  auto worker = ChildProcess::start({IRSIG_SYNTHETIC_WORKER, "--coordinator", address.text,
                                     "--name", "a", "--exit-when-finished", "--spool", folder_},
                                    root_ + "/a.log", SIGKILL);
  ASSERT_TRUE(worker.ok());
  EXPECT_TRUE(worker->wait(30));
  EXPECT_TRUE(worker->succeeded()) << worker->last_words();
  std::vector<std::string> keys;
  for (const auto& found : open()->take_over(kEvery)) keys.push_back(found.record.job_key());
  EXPECT_THAT(keys, testing::ElementsAre("y")) << "x is no result at all, and nobody's";
}

}  // namespace
}  // namespace irsig
