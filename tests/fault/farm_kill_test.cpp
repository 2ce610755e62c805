// Real processes, killed at random: whatever dies, the database is that of an undisturbed run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <thread>

#include "absl/strings/str_cat.h"
#include "coordinator/client/child_process.h"
#include "coordinator/client/farm_client.h"
#include "coordinator/client/local_farm.h"
#include "coordinator/farm_server.h"
#include "jobs/check_resolved.h"
#include "schema/store/reader.h"
#include "tests/fault/synthetic_farm.h"

namespace irsig {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

struct Process {
  pid_t pid;
  std::string name;  // at most 15 characters
};

// Reads the state from /proc/<pid>/stat: "pid (name) state ppid ...".
std::vector<Process> children_of(pid_t parent) {
  std::vector<Process> out;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    std::ifstream in(entry.path() / "stat");
    std::string line;
    if (!std::getline(in, line)) continue;
    const auto open = line.find('('), close = line.rfind(')');
    if (open == std::string::npos || line.size() < close + 4) continue;
    if (std::atoi(line.c_str() + close + 4) != parent || line[close + 2] == 'Z') continue;
    out.push_back({std::atoi(line.c_str()), line.substr(open + 1, close - open - 1)});
  }
  return out;
}

class FarmKillTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = "/tmp/irsig-kill-XXXXXX";
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    setenv("TMPDIR", folder_.c_str(), 1);  // what a killed run leaves behind is swept up here
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  LocalFarmPlan plan(const std::string& db, std::uint32_t workers,
                     std::vector<std::string> arguments) {
    return {.db_path = folder_ + "/" + db,
            .workers = workers,
            .coordinator_executable = IRSIG_COORDINATOR,
            .worker_executable = IRSIG_SYNTHETIC_WORKER,
            .worker_arguments = std::move(arguments)};
  }

  // Runs a sweep to its end; `disturb` is called every few milliseconds until then, with the jobs
  // settled so far.
  schema::SweepStatus run(
      const LocalFarmPlan& plan, const schema::ResolvedSweep& sweep,
      const std::function<void(std::uint64_t settled)>& disturb = [](auto) {}) {
    auto farm = LocalFarm::start(plan);
    EXPECT_TRUE(farm.ok()) << farm.status();
    if (!farm.ok()) return {};
    EXPECT_TRUE(submit((*farm)->address(), sweep, {}, 1).ok());
    EXPECT_TRUE((*farm)->start_workers().ok());
    std::uint64_t settled = 0;
    const auto deadline = steady_clock::now() + std::chrono::seconds(120);
    while (steady_clock::now() < deadline) {
      const auto status = farm_status((*farm)->address(), 2);
      if (status.ok() && status->sweep_size() == 1) {
        const auto& one = status->sweep(0);
        settled = one.done() + one.quarantined();
        if (settled == one.jobs()) {
          EXPECT_TRUE((*farm)->stop().ok());
          return one;
        }
      }
      disturb(settled);
      const auto alive = (*farm)->keep_alive(settled);
      EXPECT_TRUE(alive.ok()) << alive;
      if (!alive.ok()) return {};
      std::this_thread::sleep_for(milliseconds(20));
    }
    ADD_FAILURE() << "the sweep did not end";
    return {};
  }

  std::string digest(const std::string& db) {
    auto reader = StoreReader::open(folder_ + "/" + db);
    EXPECT_TRUE(reader.ok()) << reader.status();
    if (!reader.ok()) return "";
    const auto digest = (*reader)->digest();
    EXPECT_TRUE(digest.ok()) << digest.status();
    return digest.value_or("");
  }

  std::string folder_;
};

TEST_F(FarmKillTest, KilledWorkersLeaveTheSameDatabase) {
  const auto sweep = frigate_sweep(60);
  ASSERT_EQ(run(plan("calm.sigdb", 1, {}), sweep).done(), 60U);
  std::mt19937 random(1);
  int kills = 0;
  std::uint64_t next_kill = 0;
  const auto kill_a_worker = [&](std::uint64_t settled) {
    if (settled < next_kill) return;
    std::vector<Process> workers;
    for (const auto& child : children_of(getpid())) {
      if (child.name.starts_with("irsig-synthetic")) workers.push_back(child);
    }
    if (workers.empty()) return;
    kill(workers[random() % workers.size()].pid, SIGKILL);
    ++kills;
    next_kill = settled + 1 + random() % 8;  // in jobs, so that a slow machine still gets on
  };
  const auto status = run(plan("killed.sigdb", 3, {"--seconds", "0.05"}), sweep, kill_a_worker);
  EXPECT_EQ(status.done(), 60U);
  EXPECT_GE(kills, 6);
  EXPECT_EQ(digest("killed.sigdb"), digest("calm.sigdb"));
}

TEST_F(FarmKillTest, AKilledCoordinatorLeavesTheSameDatabase) {
  const auto sweep = frigate_sweep(60);
  ASSERT_EQ(run(plan("calm.sigdb", 2, {}), sweep).done(), 60U);
  int kills = 0;
  auto next_kill = steady_clock::now() + milliseconds(300);
  const auto kill_the_coordinator = [&](std::uint64_t) {
    if (kills == 4 || steady_clock::now() < next_kill) return;
    for (const auto& child : children_of(getpid())) {
      if (child.name.starts_with("irsig-coordinat")) kills += kill(child.pid, SIGKILL) == 0;
    }
    std::this_thread::sleep_for(milliseconds(50));  // its end is seen by keep_alive
    next_kill = steady_clock::now() + milliseconds(330);
  };
  const auto status =
      run(plan("killed.sigdb", 2, {"--seconds", "0.06"}), sweep, kill_the_coordinator);
  EXPECT_EQ(status.done(), 60U);
  EXPECT_GE(kills, 2);
  EXPECT_EQ(digest("killed.sigdb"), digest("calm.sigdb"));
}

TEST_F(FarmKillTest, ASweepGoesOnInAnotherRun) {
  const auto sweep = frigate_sweep(30);
  ASSERT_EQ(run(plan("calm.sigdb", 2, {}), sweep).done(), 30U);
  {
    auto farm = LocalFarm::start(plan("resumed.sigdb", 2, {"--seconds", "0.05"}));
    ASSERT_TRUE(farm.ok()) << farm.status();
    ASSERT_TRUE(submit((*farm)->address(), sweep, {}, 1).ok());
    ASSERT_TRUE((*farm)->start_workers().ok());
    std::this_thread::sleep_for(milliseconds(400));
    for (const auto& child : children_of(getpid())) kill(child.pid, SIGKILL);
  }
  EXPECT_EQ(run(plan("resumed.sigdb", 3, {}), sweep).done(), 30U);
  EXPECT_EQ(digest("resumed.sigdb"), digest("calm.sigdb"));
}

TEST_F(FarmKillTest, AJobThatFailsOrKillsItsWorkerIsSetAsideAndTheRestIsDone) {
  const auto status =
      run(plan("bad.sigdb", 2, {"--failing", "3", "--crashing", "5"}), frigate_sweep(20));
  EXPECT_EQ(status.done(), 18U);
  EXPECT_EQ(status.quarantined(), 2U);
  EXPECT_THAT(status.failure(),
              testing::UnorderedElementsAre(testing::HasSubstr("viewpoint 3 is cursed"),
                                            testing::HasSubstr("its worker was lost")));
}

// Temperatures first, then the views that need them.
TEST_F(FarmKillTest, KilledWorkersLeaveTheSameTemperatures) {
  const auto sweep = heated_frigate_sweep(20);
  const std::uint64_t jobs = 20 + static_cast<std::uint64_t>(sweep.heat_size());
  ASSERT_GE(sweep.heat_size(), 2);
  ASSERT_EQ(run(plan("calm.sigdb", 1, {}), sweep).done(), jobs);
  std::uint64_t next_kill = 0;
  int kills = 0;
  const auto kill_a_worker = [&](std::uint64_t settled) {
    if (settled < next_kill) return;
    for (const auto& child : children_of(getpid())) {
      if (!child.name.starts_with("irsig-synthetic")) continue;
      kills += kill(child.pid, SIGKILL) == 0;
      break;
    }
    next_kill = settled + 1;
  };
  const auto status = run(plan("killed.sigdb", 2, {"--seconds", "0.05"}), sweep, kill_a_worker);
  EXPECT_EQ(status.done(), jobs);
  EXPECT_EQ(status.heat_done(), status.heat_jobs());
  EXPECT_GE(kills, 4);
  EXPECT_EQ(digest("killed.sigdb"), digest("calm.sigdb"));
}

TEST_F(FarmKillTest, ARunThatIsKilledBetweenItsStagesGoesOnInAnotherRun) {
  const auto sweep = heated_frigate_sweep(10);
  const std::uint64_t jobs = 10 + static_cast<std::uint64_t>(sweep.heat_size());
  ASSERT_EQ(run(plan("calm.sigdb", 2, {}), sweep).done(), jobs);
  for (const std::uint64_t stop_after : {std::uint64_t{1}, jobs - 10, jobs - 9}) {
    const std::string db = absl::StrCat("resumed", stop_after, ".sigdb");
    {
      auto farm = LocalFarm::start(plan(db, 1, {"--seconds", "0.05"}));
      ASSERT_TRUE(farm.ok()) << farm.status();
      ASSERT_TRUE(submit((*farm)->address(), sweep, {}, 1).ok());
      ASSERT_TRUE((*farm)->start_workers().ok());
      while (farm_status((*farm)->address())->sweep(0).done() < stop_after)
        std::this_thread::sleep_for(milliseconds(5));
      for (const auto& child : children_of(getpid())) kill(child.pid, SIGKILL);
    }
    EXPECT_EQ(run(plan(db, 2, {}), sweep).done(), jobs);
    EXPECT_EQ(digest(db), digest("calm.sigdb"));
  }
}

TEST_F(FarmKillTest, TemperaturesThatCannotBeComputedEndTheRunWithTheReason) {
  const auto sweep = heated_frigate_sweep(20);
  const auto heat_jobs = static_cast<std::uint64_t>(sweep.heat_size());
  const auto status = run(plan("bad.sigdb", 2, {"--failing-heat", "1"}), sweep);
  EXPECT_EQ(status.done(), heat_jobs - 1);
  EXPECT_EQ(status.quarantined(), 21U);
  ASSERT_EQ(status.failure_size(), 2);
  EXPECT_THAT(status.failure(0),
              testing::HasSubstr("job 1 (temperatures of \"" + sweep.heat(1).season() + "\")"));
  EXPECT_THAT(status.failure(0), testing::HasSubstr("heat run 1 is cursed"));
  EXPECT_THAT(status.failure(1), testing::HasSubstr("20 jobs"));
  EXPECT_THAT(status.failure(1), testing::HasSubstr("need job 1, which was given up"));
  // Again, with workers that can.
  EXPECT_EQ(run(plan("bad.sigdb", 2, {}), sweep).done(), heat_jobs + 20);
}

TEST_F(FarmKillTest, AnotherDeterminismClassEndsTheRunWithItsReason) {
  const auto sweep = frigate_sweep(2);
  {
    auto farm = LocalFarm::start(plan("class.sigdb", 1, {"--failing", "1"}));
    ASSERT_TRUE(farm.ok());
    ASSERT_TRUE(submit((*farm)->address(), sweep, {}, 1).ok());
    ASSERT_TRUE((*farm)->start_workers().ok());
    while (farm_status((*farm)->address())->sweep(0).done() == 0) {
      std::this_thread::sleep_for(milliseconds(5));
    }
    ASSERT_TRUE((*farm)->stop().ok());
  }
  auto farm = LocalFarm::start(plan("class.sigdb", 1, {"--class", "another"}));
  ASSERT_TRUE(farm.ok());
  ASSERT_TRUE(submit((*farm)->address(), sweep, {}, 1).ok());
  ASSERT_TRUE((*farm)->start_workers().ok());
  absl::Status alive;
  for (int i = 0; i < 500 && alive.ok(); ++i) {
    alive = (*farm)->keep_alive(0);
    std::this_thread::sleep_for(milliseconds(10));
  }
  EXPECT_TRUE(absl::IsFailedPrecondition(alive)) << alive;
  EXPECT_THAT(std::string(alive.message()), testing::HasSubstr("determinism class \"synthetic\""));
}

// Children of a process that is killed die with it.
TEST_F(FarmKillTest, NothingOutlivesAKilledRun) {
  auto driver = ChildProcess::start({IRSIG_FARM_DRIVER, folder_ + "/driven.sigdb"},
                                    folder_ + "/driver.log", SIGKILL);
  ASSERT_TRUE(driver.ok()) << driver.status();
  std::vector<Process> children;
  for (int i = 0; i < 1000 && children.size() < 2; ++i) {
    std::this_thread::sleep_for(milliseconds(10));
    children = children_of(driver->pid());
  }
  ASSERT_EQ(children.size(), 2U) << driver->last_words();
  driver->signal(SIGKILL);
  EXPECT_TRUE(driver->wait(5));
  for (const auto& child : children) {
    int i = 0;
    for (; i < 1000 && std::filesystem::exists(absl::StrCat("/proc/", child.pid)); ++i) {
      std::ifstream in(absl::StrCat("/proc/", child.pid, "/stat"));
      std::string line;
      if (std::getline(in, line) && line[line.rfind(')') + 2] == 'Z') break;  // nobody to reap it
      std::this_thread::sleep_for(milliseconds(10));
    }
    EXPECT_LT(i, 1000) << child.name << " outlived its parent";
  }
}

// Three workers, of which one has another last bit in every result: it ends with the reason, the
// others compute everything, and the database is that of a calm run.
TEST_F(FarmKillTest, AWorkerWithAWrongBitIsFoundAndWhatItStoredIsReplaced) {
  constexpr std::uint32_t kViews = 40;
  const auto sweep = frigate_sweep(kViews);
  ASSERT_EQ(run(plan("calm.sigdb", 1, {}), sweep).done(), kViews);
  const auto address = *parse_address("unix:" + folder_ + "/farm");
  auto coordinator = ChildProcess::start({IRSIG_COORDINATOR, "--db", folder_ + "/wrong.sigdb",
                                          "--listen", address.text, "--audit-share", "1"},
                                         folder_ + "/coordinator.log", SIGKILL);
  ASSERT_TRUE(coordinator.ok());
  while (!farm_status(address, 1).ok()) std::this_thread::sleep_for(milliseconds(5));
  std::map<std::string, ChildProcess> workers;
  for (const char* name : {"wrong", "a", "b"}) {
    std::vector<std::string> arguments = {
        IRSIG_SYNTHETIC_WORKER, "--coordinator", address.text, "--name", name, "--seconds", "0.02"};
    if (name == std::string("wrong"))
      for (std::uint32_t view = 0; view < kViews; ++view) {
        arguments.emplace_back("--wrong");
        arguments.push_back(std::to_string(view));
      }
    auto child = ChildProcess::start(arguments, folder_ + "/" + name + ".log", SIGKILL);
    ASSERT_TRUE(child.ok());
    workers.emplace(name, *std::move(child));
  }
  // With two results that differ nobody is right: all three workers are there before the first job.
  const auto status_of = [&](auto&& fact) {
    for (int i = 0; i < 6000; ++i, std::this_thread::sleep_for(milliseconds(10)))
      if (const auto now = farm_status(address, 5); now.ok() && fact(*now)) return true;
    return false;
  };
  ASSERT_TRUE(status_of([](const auto& now) { return now.worker_size() == 3; }));
  ASSERT_TRUE(submit(address, sweep, {}, 1).ok());
  EXPECT_TRUE(workers.at("wrong").wait(60));
  EXPECT_EQ(workers.at("wrong").ended(), "exit code 3");
  EXPECT_TRUE(status_of([](const auto& now) { return now.sweep(0).done() == kViews; }));
  for (const char* name : {"a", "b"}) {
    workers.at(name).signal(SIGTERM);
    EXPECT_TRUE(workers.at(name).wait(60)) << name;
    EXPECT_EQ(workers.at(name).ended(), "exit code 0") << name;
  }
  EXPECT_THAT(workers.at("wrong").last_words(), testing::HasSubstr("this worker was set aside"));
  const auto told = farm_status(address);
  ASSERT_TRUE(told.ok()) << told.status();
  EXPECT_EQ(told->sweep(0).done(), kViews);
  EXPECT_GE(told->audited(), 1U);
  EXPECT_GE(told->differing(), 1U);
  for (const schema::WorkerStatus& worker : told->worker())
    EXPECT_EQ(worker.state() == schema::WorkerStatus::STATE_SET_ASIDE, worker.name() == "wrong");
  coordinator->signal(SIGTERM);
  EXPECT_TRUE(coordinator->wait(20));
  EXPECT_EQ(digest("wrong.sigdb"), digest("calm.sigdb"));
}

// A worker that is stopped, not killed, keeps its connection: only its silence tells.
TEST_F(FarmKillTest, AStoppedWorkerLosesItsJobAndItsLateResultIsKnownAgain) {
  const auto seconds = [] {
    return std::chrono::duration<double>(steady_clock::now().time_since_epoch()).count();
  };
  const auto address = *parse_address("unix:" + folder_ + "/farm");
  auto server = FarmServer::start({folder_ + "/stopped.sigdb",
                                   address,
                                   {0.2, 1, 5},
                                   seconds,
                                   seconds,
                                   [](const absl::Status& status) { ADD_FAILURE() << status; },
                                     check_resolved});
  ASSERT_TRUE(server.ok()) << server.status();
  ASSERT_TRUE(submit(address, frigate_sweep(1), {}, 1).ok());
  auto slow = ChildProcess::start({IRSIG_SYNTHETIC_WORKER, "--coordinator", address.text, "--name",
                                   "slow", "--seconds", "0.3", "--exit-when-finished"},
                                  folder_ + "/slow.log", SIGKILL);
  ASSERT_TRUE(slow.ok());
  while (farm_status(address)->sweep(0).leased() == 0) {
    std::this_thread::sleep_for(milliseconds(5));
  }
  slow->signal(SIGSTOP);
  WorkerPlan other;
  other.coordinator = address;
  other.worker_name = "other";
  other.determinism_class = kSyntheticClass;
  other.physics_version = 1;
  other.exit_when_finished = true;
  const std::atomic<bool> stop = false;
  EXPECT_TRUE(run_lease_loop(other, synthetic_runner({}), stop).ok());
  EXPECT_EQ(farm_status(address)->sweep(0).done(), 1U);
  slow->signal(SIGCONT);
  EXPECT_TRUE(slow->wait(20));
  EXPECT_TRUE(slow->succeeded()) << slow->last_words();
  const auto ended = farm_status(address);
  ASSERT_TRUE(ended.ok()) << ended.status();
  EXPECT_EQ(ended->sweep(0).done(), 1U);
  EXPECT_EQ(ended->audited(), 1U) << "two workers have computed it";
  EXPECT_EQ(ended->differing(), 0U);
  EXPECT_TRUE((*server)->stop().ok());
}

}  // namespace
}  // namespace irsig
