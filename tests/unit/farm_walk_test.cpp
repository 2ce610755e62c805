// The tables of farm_table.h: row by row, and over every state that two workers and two jobs can be
// in. The states are found breadth-first by the tables alone; then a real farm on a real store
// makes every step between them, and must come to the same states: nothing lost, nothing doubled.
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <optional>
#include <queue>
#include <set>
#include <tuple>
#include <vector>

#include "schema/store/tables/content.h"
#include "tests/unit/farm_fixture.h"

namespace irsig {
namespace {

using J = JobState;
using S = SessionState;

// Rules of the farm, written down a second time by its duties and not by its rows.
TEST(FarmTable, EveryRowOfJobs) {
  for (const JobRow& row : kJobTable) {
    SCOPED_TRACE(testing::Message() << "state " << static_cast<int>(row.state) << ", event "
                                    << static_cast<int>(row.event));
    const bool refused = row.action == JobAction::kRefuse;
    if (refused || row.action == JobAction::kCompare || row.action == JobAction::kDrop) {
      EXPECT_EQ(row.next, row.state) << "nothing changes";
    }
    switch (row.event) {
      case JobEvent::kResult:
        EXPECT_EQ(row.action, row.state == J::kDone        ? JobAction::kCompare
                              : row.state == J::kCancelled ? JobAction::kDrop
                                                           : JobAction::kStore);
        EXPECT_EQ(row.next, row.state == J::kCancelled ? J::kCancelled : J::kDone);
        break;
      case JobEvent::kLease:
        EXPECT_EQ(refused, row.state != J::kWaiting);
        if (!refused) {
          EXPECT_EQ(row.next, J::kLeased);
        }
        break;
      case JobEvent::kRelease:
      case JobEvent::kFail:
        EXPECT_EQ(refused, row.state != J::kLeased);
        if (!refused) {
          EXPECT_EQ(row.next, J::kWaiting);
        }
        break;
      case JobEvent::kGiveUp:
        EXPECT_EQ(refused, row.state != J::kLeased && row.state != J::kWaiting);
        if (!refused) {
          EXPECT_EQ(row.next, J::kQuarantined);
        }
        break;
      case JobEvent::kCancel:
        EXPECT_EQ(row.next,
                  row.state == J::kWaiting || row.state == J::kLeased ? J::kCancelled : row.state);
        break;
      case JobEvent::kSubmit:
        EXPECT_EQ(row.next, row.state == J::kQuarantined || row.state == J::kCancelled ? J::kWaiting
                                                                                       : row.state);
        break;
    }
    if (row.state == J::kDone) {
      EXPECT_EQ(row.next, J::kDone) << "what is stored stays";
    }
  }
}

TEST(FarmTable, EveryRowOfWorkers) {
  using A = SessionAction;
  using E = SessionEvent;
  for (const SessionRow& row : kSessionTable) {
    SCOPED_TRACE(testing::Message() << "state " << static_cast<int>(row.state) << ", event "
                                    << static_cast<int>(row.event));
    const bool trusted = row.state == S::kIdle || row.state == S::kComputing;
    if (row.action == A::kRefuse) {
      EXPECT_EQ(row.next, row.state);
    }
    if (row.state == S::kLost) {
      EXPECT_EQ(row.action, A::kRefuse);
      continue;
    }
    // A job goes back exactly when its worker stops computing it without a word of it.
    EXPECT_EQ(
        row.action == A::kRelease || row.action == A::kReleaseThenLease,
        row.state == S::kComputing && (row.event == E::kSilence || row.event == E::kSuccessor ||
                                       row.event == E::kDistrust || row.event == E::kAskForJob));
    switch (row.event) {
      case E::kAskForJob:
        EXPECT_EQ(row.action == A::kRefuse, !trusted);
        break;
      case E::kHeartbeat:
        EXPECT_EQ(row.action, trusted ? A::kNone : A::kAnswerInvalid);
        EXPECT_EQ(row.next, row.state);
        break;
      case E::kForeignHeartbeat:
        EXPECT_EQ(row.action, A::kAnswerInvalid);
        EXPECT_EQ(row.next, row.state);
        break;
      case E::kResult:
      case E::kOtherResult:
        EXPECT_EQ(row.action, trusted ? A::kTake : A::kRefuse);
        EXPECT_EQ(row.next, row.event == E::kResult && trusted ? S::kIdle : row.state);
        break;
      case E::kFailure:
        EXPECT_EQ(row.action, row.state == S::kComputing ? A::kCountFailure : A::kRefuse);
        break;
      case E::kForeignFailure:
        EXPECT_EQ(row.action, A::kRefuse);
        break;
      case E::kSilence:
      case E::kSuccessor:
        EXPECT_EQ(row.next, S::kLost);
        break;
      case E::kDistrust:
        EXPECT_EQ(row.next, S::kAside);
        break;
    }
  }
}

// Two workers and two jobs, by the tables alone.
struct Worker {
  S state = S::kLost;
  int job = -1;            // that it computes; -1: none
  bool has_lease = false;  // of that job, and not only the wish
  unsigned spool = 0;      // bit j: a result of job j, computed and not acknowledged
  [[nodiscard]] auto key() const { return std::tuple(state, job, has_lease, spool); }
};
struct World {
  std::array<J, 2> job = {J::kWaiting, J::kWaiting};
  std::array<Worker, 2> worker;
  [[nodiscard]] auto key() const { return std::tuple(job, worker[0].key(), worker[1].key()); }
  bool operator<(const World& other) const { return key() < other.key(); }
  // Returns the world with the names of the workers exchanged.
  [[nodiscard]] World mirrored() const { return {job, {worker[1], worker[0]}}; }
};

enum class Act {
  kRegister,  // for the first time, or again after it was killed
  kAsk,
  kReturn,   // the result of the job that it computes
  kSpool,    // it has computed it, and cannot deliver it
  kDeliver,  // from its spool, the first there is
  kGiveUp,   // its job fails for good
  kSilence,
  kRestart,  // of the coordinator
  kCancel,
  kSubmit
};
struct Step {
  Act act;
  int worker = 0;
  bool of_one = true;  // worker, and not the coordinator
};

std::vector<Step> all_steps() {
  std::vector<Step> out;
  for (const Act act : {Act::kRegister, Act::kAsk, Act::kReturn, Act::kSpool, Act::kDeliver,
                        Act::kGiveUp, Act::kSilence})
    for (const int worker : {0, 1}) out.push_back({act, worker});
  for (const Act act : {Act::kRestart, Act::kCancel, Act::kSubmit}) out.push_back({act, 0, false});
  return out;
}

class Model {
 public:
  // nullopt: it cannot happen.
  static std::optional<World> after(World world, const Step& step) {
    Worker& worker = world.worker[static_cast<std::size_t>(step.worker)];
    switch (step.act) {
      case Act::kRegister:
        session(world, worker, SessionEvent::kSuccessor);
        worker.state = S::kIdle;
        return world;
      case Act::kAsk:
        // A worker delivers what it has before it asks for more.
        if (worker.state == S::kLost || worker.spool != 0) return std::nullopt;
        session(world, worker, SessionEvent::kAskForJob);
        for (int j = 0; j < 2; ++j) {
          if (world.job[static_cast<std::size_t>(j)] != J::kWaiting) continue;
          job(world, j, JobEvent::kLease);
          worker.state = S::kComputing;
          worker.job = j;
          worker.has_lease = true;
          break;
        }
        return world;
      case Act::kReturn: {
        if (worker.state != S::kComputing) return std::nullopt;
        const int j = worker.job;
        worker.spool &= ~(1U << static_cast<unsigned>(j));
        session(world, worker, SessionEvent::kResult);
        result(world, j);
        return world;
      }
      case Act::kSpool:
        if (worker.state != S::kComputing ||
            (worker.spool >> static_cast<unsigned>(worker.job) & 1U))
          return std::nullopt;
        worker.spool |= 1U << static_cast<unsigned>(worker.job);
        return world;
      case Act::kDeliver: {
        if (worker.state == S::kLost || worker.spool == 0) return std::nullopt;
        const int j = (worker.spool & 1U) ? 0 : 1;
        worker.spool &= ~(1U << static_cast<unsigned>(j));
        session(world, worker, SessionEvent::kOtherResult);
        result(world, j);
        return world;
      }
      case Act::kGiveUp: {
        if (worker.state != S::kComputing) return std::nullopt;
        const int j = worker.job;
        const bool counts = worker.has_lease;
        session(world, worker, SessionEvent::kFailure);
        if (counts) job(world, j, JobEvent::kGiveUp);
        return world;
      }
      case Act::kSilence:
        if (worker.state == S::kLost) return std::nullopt;
        session(world, worker, SessionEvent::kSilence);
        return world;
      case Act::kRestart:
        for (Worker& each : world.worker) session(world, each, SessionEvent::kSilence);
        return world;
      case Act::kCancel:
      case Act::kSubmit:
        for (int j = 0; j < 2; ++j) {
          job(world, j, step.act == Act::kCancel ? JobEvent::kCancel : JobEvent::kSubmit);
          if (step.act == Act::kCancel) end_leases(world, j);
        }
        return world;
    }
    return std::nullopt;
  }

 private:
  static void job(World& world, int j, JobEvent event) {
    J& state = world.job[static_cast<std::size_t>(j)];
    state = next(state, event).next;
  }
  static void end_leases(World& world, int j) {
    for (Worker& worker : world.worker)
      if (worker.job == j) worker.has_lease = false;
  }
  static void result(World& world, int j) {
    if (next(world.job[static_cast<std::size_t>(j)], JobEvent::kResult).action == JobAction::kStore)
      end_leases(world, j);
    job(world, j, JobEvent::kResult);
  }
  static void session(World& world, Worker& worker, SessionEvent event) {
    const SessionRow& row = next(worker.state, event);
    if ((row.action == SessionAction::kRelease || row.action == SessionAction::kReleaseThenLease) &&
        worker.has_lease)
      job(world, worker.job, JobEvent::kRelease);
    worker.state = row.next;
    if (worker.state == S::kComputing) return;
    worker.job = -1;
    worker.has_lease = false;
  }
};

class FarmWalk : public FarmTest {
 protected:
  void SetUp() override {
    FarmTest::SetUp();
    sweep_ = frigate_sweep(2);
    auto submission = make_submission(check_resolved, sweep_, 1, {});
    ASSERT_TRUE(submission.ok());
    submission_ = *std::move(submission);
    ASSERT_EQ(submission_.jobs.size(), 2U);
    for (std::size_t j = 0; j < 2; ++j) {
      result_[j] = synthetic_result(sweep_, submission_.jobs[j]);
      content_[j] = content_sha256(result_[j]);
    }
    begin_again();
  }
  void TearDown() override {
    store_->rollback();
    FarmTest::TearDown();
  }

  // The whole walk is one transaction, so that all can be undone.
  void begin_again() {
    store_->rollback();
    ASSERT_TRUE(store_->begin().ok());
    new_farm();
    ASSERT_TRUE(farm_->submit(submission_).ok());
    world_ = {};
    id_ = {};
    token_ = {};
  }
  void new_farm() {
    farm_ = std::make_unique<Farm>(
        *store_, rules_, [this] { return now_s_; }, [] { return 1.7e9; },
        "start " + std::to_string(++starts_), check_resolved);
  }

  void make(const Step& step) {
    const auto w = static_cast<std::size_t>(step.worker);
    const Worker& worker = world_.worker[w];
    const auto give = [&](int job, std::uint64_t token) {
      const auto j = static_cast<std::size_t>(job);
      const auto reply = farm_->complete({.worker_id = id_[w],
                                          .fencing_token = token,
                                          .sweep_sha256 = submission_.sweep_sha256,
                                          .result = result_[j],
                                          .content_sha256 = content_[j]});
      ASSERT_TRUE(reply.ok()) << reply.status();
      using R = schema::CompleteReply;
      EXPECT_EQ(reply->state(), world_.job[j] == J::kDone        ? R::STATE_KNOWN
                                : world_.job[j] == J::kCancelled ? R::STATE_NOT_WANTED
                                                                 : R::STATE_STORED);
    };
    switch (step.act) {
      case Act::kRegister: {
        schema::RegisterRequest request;
        request.set_worker_name(w == 0 ? "a" : "b");
        request.set_determinism_class(kSyntheticClass);
        request.set_physics_version(1);
        const auto reply = farm_->register_worker(request);
        ASSERT_TRUE(reply.ok()) << reply.status();
        id_[w] = reply->worker_id();
        break;
      }
      case Act::kAsk: {
        schema::LeaseRequest request;
        request.set_worker_id(id_[w]);
        const auto reply = farm_->lease(request);
        ASSERT_TRUE(reply.ok()) << reply.status();
        token_[w] = reply->fencing_token();
        break;
      }
      case Act::kReturn:
        give(worker.job, token_[w]);
        break;
      case Act::kSpool:
        break;  // the farm hears nothing of it
      case Act::kDeliver:
        give((worker.spool & 1U) ? 0 : 1, 0);
        break;
      case Act::kGiveUp: {
        schema::FailRequest request;
        request.set_worker_id(id_[w]);
        request.set_fencing_token(token_[w]);
        request.set_kind(schema::FailRequest::KIND_BAD_INPUT);
        ASSERT_TRUE(farm_->fail(request).ok());
        break;
      }
      case Act::kSilence:
        for (int second = 0; second < 11; ++second) {
          now_s_ += 1;
          const std::size_t other = 1 - w;
          if (world_.worker[other].state != S::kLost) {
            schema::HeartbeatRequest beat;
            beat.set_worker_id(id_[other]);
            ASSERT_TRUE(farm_->heartbeat(beat).ok());
          }
          if (farm_->somebody_is_silent()) {
            ASSERT_TRUE(farm_->drop_silent_workers().ok());
          }
        }
        break;
      case Act::kRestart:
        ASSERT_TRUE(store_->release_all().ok());
        new_farm();
        break;
      case Act::kCancel:
        ASSERT_TRUE(farm_->cancel(submission_.sweep_sha256).ok());
        break;
      case Act::kSubmit:
        ASSERT_TRUE(farm_->submit(submission_).ok());
        break;
    }
  }

  // Compares the statements of farm and store with the expected world.
  void check(const World& expected) {
    std::uint64_t rays = 0;
    for (std::size_t j = 0; j < 2; ++j) {
      const auto known = store_->find_job(submission_.sweep_sha256, submission_.jobs[j].job_key());
      ASSERT_TRUE(known.ok() && known->has_value()) << known.status();
      EXPECT_EQ((*known)->job.state, expected.job[j]) << "job " << j;
      EXPECT_EQ((*known)->job.fencing_token != 0, expected.job[j] == J::kLeased) << "job " << j;
      if (expected.job[j] == J::kDone) {
        EXPECT_EQ((*known)->content_sha256, content_[j]);
        rays += result_[j].rays();
      }
    }
    const auto status = farm_->status();
    ASSERT_TRUE(status.ok()) << status.status();
    EXPECT_EQ(status->sweep(0).rays(), rays) << "each done job once";
    EXPECT_EQ(status->differing(), 0U);
    std::map<std::string, const schema::WorkerStatus*> there;
    for (const auto& worker : status->worker()) there[worker.name()] = &worker;
    for (std::size_t w = 0; w < 2; ++w) {
      const Worker& worker = expected.worker[w];
      const auto found = there.find(w == 0 ? "a" : "b");
      ASSERT_EQ(found != there.end(), worker.state != S::kLost) << "worker " << w;
      if (found == there.end()) continue;
      EXPECT_EQ(
          found->second->job_key(),
          worker.job < 0 ? "" : submission_.jobs[static_cast<std::size_t>(worker.job)].job_key());
    }
  }

  Submission submission_;
  std::array<schema::JobResult, 2> result_;
  std::array<std::string, 2> content_, id_;
  std::array<std::uint64_t, 2> token_{};
  World world_;
  int starts_ = 0;
};

TEST_F(FarmWalk, TheRealFarmMakesEveryStepOfTwoWorkersAndTwoJobs) {
  // Breadth-first, by the tables.
  const std::vector<Step> steps = all_steps();
  struct Edge {
    std::size_t to;
    Step step;
    bool made = false;
  };
  std::map<World, std::size_t> number = {{World(), 0}};
  std::vector<World> worlds = {World()};
  std::vector<std::vector<Edge>> edges;
  for (std::size_t at = 0; at < worlds.size(); ++at) {
    edges.emplace_back();
    for (const Step& step : steps) {
      const auto to = Model::after(worlds[at], step);
      if (!to) continue;
      const auto [found, is_new] = number.emplace(*to, worlds.size());
      if (is_new) worlds.push_back(*to);
      edges.back().push_back({found->second, step});
      for (std::size_t j = 0; j < 2; ++j) {
        if (worlds[at].job[j] == J::kDone) {
          ASSERT_EQ(to->job[j], J::kDone) << "lost";
        }
        const auto holders = std::count_if(
            to->worker.begin(), to->worker.end(),
            [&](const auto& w) { return w.has_lease && w.job == static_cast<int>(j); });
        ASSERT_EQ(holders, to->job[j] == J::kLeased ? 1 : 0) << "a lease has one holder";
      }
    }
  }
  // Wherever it is, all can still be done.
  std::vector<std::vector<std::size_t>> before(worlds.size());
  for (std::size_t at = 0; at < worlds.size(); ++at)
    for (const Edge& edge : edges[at]) before[edge.to].push_back(at);
  std::set<std::size_t> good;
  std::queue<std::size_t> next_ones;
  for (std::size_t at = 0; at < worlds.size(); ++at)
    if (worlds[at].job == std::array{J::kDone, J::kDone}) {
      good.insert(at);
      next_ones.push(at);
    }
  for (; !next_ones.empty(); next_ones.pop())
    for (const std::size_t at : before[next_ones.front()])
      if (good.insert(at).second) next_ones.push(at);
  EXPECT_EQ(good.size(), worlds.size());

  // The real farm: always to the nearest step that it has not made yet.
  std::size_t at = 0, made = 0, walked = 0, begun = 1;
  const auto way_to_the_next = [&]() -> std::vector<std::pair<std::size_t, std::size_t>> {
    std::vector<std::pair<std::size_t, std::size_t>> from(worlds.size(), {~std::size_t{0}, 0});
    std::queue<std::size_t> open;
    open.push(at);
    from[at] = {at, 0};
    for (; !open.empty(); open.pop()) {
      const std::size_t here = open.front();
      for (std::size_t e = 0; e < edges[here].size(); ++e) {
        const Edge& edge = edges[here][e];
        if (!edge.made) {
          std::vector<std::pair<std::size_t, std::size_t>> way = {{here, e}};
          for (std::size_t back = here; back != at; back = from[back].first)
            way.insert(way.begin(), from[back]);
          return way;
        }
        if (from[edge.to].first != ~std::size_t{0}) continue;
        from[edge.to] = {here, e};
        open.push(edge.to);
      }
    }
    return {};
  };
  for (;;) {
    const auto way = way_to_the_next();
    if (way.empty()) {
      if (at == 0) break;
      begin_again();
      at = 0;
      ++begun;
      continue;
    }
    for (const auto& [here, e] : way) {
      Edge& edge = edges[here][e];
      SCOPED_TRACE(testing::Message()
                   << "state " << here << ", step " << static_cast<int>(edge.step.act)
                   << " of worker " << edge.step.worker);
      make(edge.step);
      at = edge.to;
      world_ = worlds[at];
      ++walked;
      if (!edge.made) {
        check(world_);
        ++made;
      }
      edge.made = true;
      // Workers differ in nothing but their names.
      for (Edge& twin : edges[number.at(worlds[here].mirrored())])
        if (twin.step.act == edge.step.act && twin.step.of_one &&
            twin.step.worker != edge.step.worker)
          twin.made = true;
      ASSERT_FALSE(HasFailure());
    }
  }
  RecordProperty("states", static_cast<int>(worlds.size()));
  RecordProperty("steps", static_cast<int>(made));
  std::printf("%zu states, %zu steps between them, %zu made in all, %zu beginnings\n",
              worlds.size(), made, walked, begun);
  EXPECT_EQ(worlds.size(), 1584U);  // docs/evidence/reliability.md
}

}  // namespace
}  // namespace irsig
