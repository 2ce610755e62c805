// The edges of the farm: addresses, budgets, texts, and the service over a real socket.
#include <gmock/gmock.h>
#include <grpcpp/client_context.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <thread>
#include <vector>

#include "coordinator/client/address.h"
#include "coordinator/client/channel.h"
#include "coordinator/client/farm_client.h"
#include "coordinator/client/fetch_asset.h"
#include "coordinator/client/progress_text.h"
#include "coordinator/client/time_budget.h"
#include "coordinator/farm_server.h"
#include "jobs/check_resolved.h"
#include "jobs/keys/expand.h"
#include "schema/farm.grpc.pb.h"
#include "tests/fault/synthetic_farm.h"

namespace irsig {
namespace {

using testing::HasSubstr;

// A port without TLS is asked for: --insecure-loopback.
Address loopback(const std::string& text) {
  return *parse_address(text, {.tls = {}, .insecure_loopback = true});
}

TEST(Address, WithoutTlsOnlyAUnixSocketUnlessMoreIsAskedFor) {
  for (const char* good : {"unix:/run/x", "unix:relative/x", "unix:///run/x"})
    EXPECT_TRUE(parse_address(good).ok()) << good;
  for (const char* port : {"127.0.0.1:50051", "127.3.2.1:1", "localhost:0", "[::1]:7"}) {
    EXPECT_THAT(std::string(parse_address(port).status().message()),
                HasSubstr("--insecure-loopback"))
        << port;
    EXPECT_TRUE(parse_address(port, {.tls = {}, .insecure_loopback = true}).ok()) << port;
  }
  for (const char* elsewhere : {"0.0.0.0:50051", "192.168.1.2:50051", "example.org:80", "[::]:5"})
    EXPECT_TRUE(absl::IsInvalidArgument(
        parse_address(elsewhere, {.tls = {}, .insecure_loopback = true}).status()))
        << elsewhere;
  for (const char* bad : {"", "unix:", "0.0.0.0:50051", "192.168.1.2:50051", "example.org:80",
                          "[::]:50051", "127.0.0.1", "127.0.0.1:", "127.0.0.1:70000",
                          "127.0.0.1:5x", "127.0.0.1.example.org:80", "*:50051"}) {
    EXPECT_TRUE(absl::IsInvalidArgument(parse_address(bad).status())) << bad;
  }
  EXPECT_THAT(std::string(parse_address("10.1.2.3:4").status().message()),
              HasSubstr("not a loopback address"));
  const NetworkOptions insecure{.tls = {}, .insecure_network = true};
  for (const char* good : {"0.0.0.0:50051", "192.168.1.2:50051", "example.org:80", "[::]:50051",
                           "127.0.0.1.example.org:80", "127.0.0.1:7", "unix:/run/x"})
    EXPECT_TRUE(parse_address(good, insecure).ok()) << good;
  for (const char* bad : {"", ":80", "*:50051", "example.org", "300.1.1.1:80", "[example.org]:80",
                          "a b:80", "../x:80"})
    EXPECT_TRUE(absl::IsInvalidArgument(parse_address(bad, insecure).status())) << bad;
  EXPECT_EQ(loopback("localhost:7").host, "localhost");
  EXPECT_EQ(loopback("[::1]:7").host, "::1");
  EXPECT_THAT(std::string(parse_address("unix:/" + std::string(200, 'x')).status().message()),
              HasSubstr("107 bytes"));
}

TEST(TimeBudget, FillsTheBudgetWithPowersOfTwo) {
  BudgetQuestion question{.budget_s = 100,
                          .workers = 2,
                          .jobs = 191,
                          .seconds_per_job = 0.01,
                          .seconds_per_sample = 1e-6,
                          .replicates = 32,
                          .max_samples_per_replicate = 1 << 20};
  // 96 waves: 1.0317 s for samples in each, 32241 of them a replicate.
  EXPECT_EQ(*samples_per_replicate_for(question), 16384U);
  question.workers = 4;  // 48 waves: 64779
  EXPECT_EQ(*samples_per_replicate_for(question), 32768U);
  question.max_samples_per_replicate = 20000;
  EXPECT_EQ(*samples_per_replicate_for(question), 16384U);
}

TEST(TimeBudget, TooLittleTimeSaysHowMuchIsNeeded) {
  const auto answer = samples_per_replicate_for({1, 1, 100, 0.05, 1e-6, 32, 1 << 20});
  EXPECT_TRUE(absl::IsInvalidArgument(answer.status()));
  EXPECT_THAT(std::string(answer.status().message()), HasSubstr("at least 5.05 s"));
  EXPECT_FALSE(samples_per_replicate_for({10, 0, 100, 0, 1e-6, 32, 1 << 20}).ok());
  EXPECT_FALSE(samples_per_replicate_for({10, 1, 100, 0, 0, 32, 1 << 20}).ok());
}

TEST(ProgressText, LeavesOutWhatWasDoneBefore) {
  schema::SweepStatus sweep;
  sweep.set_jobs(191);
  sweep.set_done(91);
  sweep.set_rays(300'000'000);
  sweep.set_worst_relative_error(0.00123);
  EXPECT_EQ(
      progress_text(sweep,
                    {.elapsed_s = 10, .done_before = 41, .rays_before = 100'000'000, .workers = 2}),
      "jobs 91/191  20 Mrays/s  0:20 left  worst error 0.12 %  2 workers");
  EXPECT_EQ(duration_text(3723.4), "1:02:03");
}

TEST(ProgressText, AWatchRatesWhatItHasSeenItself) {
  schema::SweepStatus sweep;
  sweep.set_jobs(100);
  sweep.set_heat_jobs(2);
  sweep.set_done(1);
  sweep.set_heat_done(1);
  SweepWatch watch;
  EXPECT_EQ(watch.text(sweep, 2, 1000), "temperatures 1 of 2, then 98 views  2 workers");
  sweep.set_heat_done(2);
  sweep.set_done(20);
  sweep.set_rays(1'000'000);
  EXPECT_EQ(watch.text(sweep, 2, 1500), "jobs 20/100  worst error 0 %  2 workers");
  sweep.set_done(40);
  sweep.set_quarantined(20);
  sweep.set_rays(3'000'000);
  EXPECT_EQ(settled_jobs(sweep), 60U);
  EXPECT_EQ(watch.text(sweep, 3, 1510),
            "jobs 40/100  200 krays/s  0:20 left  worst error 0 %  20 failed  3 workers");
}

TEST(ProgressText, SaysTheStages) {
  schema::SweepStatus sweep;
  sweep.set_jobs(193);
  sweep.set_heat_jobs(2);
  sweep.set_done(1);
  sweep.set_heat_done(1);
  EXPECT_EQ(progress_text(sweep, {.elapsed_s = 10, .workers = 2}),
            "temperatures 1 of 2, then 191 views  2 workers");
  sweep.set_heat_done(2);
  sweep.set_done(2);
  EXPECT_EQ(progress_text(sweep, {.elapsed_s = 10, .done_before = 2, .workers = 2}),
            "jobs 2/193  2 workers");
}

class ServerTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "/irsig-server-XXXXXX";
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] absl::StatusOr<std::unique_ptr<FarmServer>> start(
      const std::string& address, const std::string& db = "test.sigdb") {
    auto parsed = parse_address(address, {.tls = {}, .insecure_loopback = true});
    if (!parsed.ok()) return parsed.status();
    const auto seconds = [] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
          .count();
    };
    return FarmServer::start({folder_ + "/" + db,
                              *parsed,
                              {0.1, 2, 5},
                              seconds,
                              seconds,
                              [](const absl::Status& status) { ADD_FAILURE() << status; },
                                     check_resolved});
  }
  [[nodiscard]] std::string socket() const { return "unix:" + folder_ + "/farm"; }

  WorkerPlan worker(const std::string& address, const std::string& name) {
    WorkerPlan plan;
    plan.coordinator = *parse_address(address);
    plan.worker_name = name;
    plan.determinism_class = kSyntheticClass;
    plan.physics_version = 1;
    plan.exit_when_finished = true;
    plan.give_up_after_s = 5;
    return plan;
  }

  std::string folder_;
  std::atomic<bool> stop_ = false;
};

TEST_F(ServerTest, ASweepGoesThroughARealSocketAndLeavesOnePlainFile) {
  auto server = start(socket());
  ASSERT_TRUE(server.ok()) << server.status();
  struct stat there {};
  ASSERT_EQ(stat((folder_ + "/farm").c_str(), &there), 0);
  EXPECT_EQ(there.st_mode & 0777, 0600U);
  const auto address = *parse_address(socket());
  const auto sweep = frigate_sweep(5);
  const auto reply = submit(address, sweep, {}, 1);
  ASSERT_TRUE(reply.ok()) << reply.status();
  EXPECT_EQ(reply->jobs(), 5U);
  EXPECT_EQ(reply->jobs_to_compute(), 5U);
  EXPECT_EQ(reply->sweep_sha256(), sha256_hex(canonical_encoding(sweep)));
  const auto stored = stored_sweep(address, reply->sweep_sha256());
  ASSERT_TRUE(stored.ok()) << stored.status();
  EXPECT_EQ(canonical_encoding(*stored), canonical_encoding(sweep));
  EXPECT_TRUE(absl::IsNotFound(stored_sweep(address, std::string(64, '0')).status()));

  std::thread other([&] {
    EXPECT_TRUE(run_lease_loop(worker(socket(), "b"), synthetic_runner({}), stop_).ok());
  });
  EXPECT_TRUE(run_lease_loop(worker(socket(), "a"), synthetic_runner({}), stop_).ok());
  other.join();
  const auto status = farm_status(address);
  ASSERT_TRUE(status.ok()) << status.status();
  EXPECT_EQ(status->sweep(0).done(), 5U);
  EXPECT_EQ(submit(address, sweep, {}, 1)->jobs_to_compute(), 0U);
  EXPECT_TRUE((*server)->stop().ok());
  std::vector<std::string> left;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    left.push_back(entry.path().filename());
  }
  EXPECT_THAT(left, testing::ElementsAre("test.sigdb"));
}

// Any program may submit, not only one that has checked the sweep.
TEST_F(ServerTest, ASweepWithEscapeSequencesInItsNamesIsRefused) {
  auto server = start(socket());
  ASSERT_TRUE(server.ok()) << server.status();
  const auto address = *parse_address(socket());
  auto sweep = frigate_sweep(1);
  sweep.mutable_sweep()->set_name("frigate\x1b]0;owned\x07");
  const auto reply = submit(address, sweep, {}, 1);
  EXPECT_TRUE(absl::IsInvalidArgument(reply.status())) << reply.status();
  EXPECT_THAT(std::string(reply.status().message()), HasSubstr("frigate?]0;owned?"));
  const auto status = farm_status(address);
  ASSERT_TRUE(status.ok()) << status.status();
  EXPECT_EQ(status->sweep_size(), 0);
}

TEST_F(ServerTest, APortInUseIsSaidAndLeavesNoDatabase) {
  auto first = start("127.0.0.1:0");
  ASSERT_TRUE(first.ok()) << first.status();
  EXPECT_THAT((*first)->address(), testing::Not(testing::EndsWith(":0")));
  auto second = start((*first)->address(), "second.sigdb");
  EXPECT_TRUE(absl::IsAlreadyExists(second.status())) << second.status();
  EXPECT_FALSE(std::filesystem::exists(folder_ + "/second.sigdb"));
  EXPECT_TRUE(farm_status(loopback((*first)->address())).ok());
}

TEST_F(ServerTest, ASocketInUseIsNotStolenAndAStaleOneIsReplaced) {
  auto first = start(socket());
  ASSERT_TRUE(first.ok()) << first.status();
  EXPECT_TRUE(absl::IsAlreadyExists(start(socket(), "second.sigdb").status()));
  EXPECT_TRUE(farm_status(*parse_address(socket())).ok());
  ASSERT_TRUE((*first)->stop().ok());
  std::ofstream(folder_ + "/farm") << "precious";
  EXPECT_TRUE(absl::IsInvalidArgument(start(socket()).status()));
  EXPECT_TRUE(std::filesystem::exists(folder_ + "/farm"));
}

TEST_F(ServerTest, AFolderThatOthersMayWriteToIsRefused) {
  ASSERT_EQ(chmod(folder_.c_str(), 0777), 0);
  EXPECT_TRUE(absl::IsInvalidArgument(start(socket()).status()));
}

TEST_F(ServerTest, AResultThatWasCutIsNotTakenForAResult) {
  auto server = start(socket());
  ASSERT_TRUE(server.ok()) << server.status();
  const auto address = *parse_address(socket());
  const auto sweep = frigate_sweep(1);
  ASSERT_TRUE(submit(address, sweep, {}, 1).ok());
  const auto farm = schema::Farm::NewStub(connect(address));
  schema::RegisterRequest request;
  request.set_worker_name("a");
  request.set_determinism_class(kSyntheticClass);
  request.set_physics_version(1);
  schema::RegisterReply registered;
  grpc::ClientContext first, second;
  ASSERT_TRUE(farm->Register(&first, request, &registered).ok());
  schema::LeaseRequest ask;
  ask.set_worker_id(registered.worker_id());
  schema::LeaseReply lease;
  ASSERT_TRUE(farm->Lease(&second, ask, &lease).ok());
  const auto bytes = synthetic_result(sweep, lease.job()).SerializeAsString();
  const auto send = [&](const std::string& piece) {
    grpc::ClientContext context;
    schema::CompleteReply reply;
    const auto stream = farm->Complete(&context, &reply);
    schema::CompleteChunk chunk;
    chunk.set_worker_id(registered.worker_id());
    chunk.set_fencing_token(lease.fencing_token());
    chunk.set_result_bytes(bytes.size());
    chunk.set_piece(piece);
    stream->Write(chunk);
    stream->WritesDone();
    return to_absl(stream->Finish());
  };
  EXPECT_TRUE(absl::IsDataLoss(send(bytes.substr(0, bytes.size() / 2))));
  EXPECT_EQ(farm_status(address)->sweep(0).leased(), 1U);
  EXPECT_TRUE(send(bytes).ok());
  EXPECT_EQ(farm_status(address)->sweep(0).done(), 1U);
}

// The next job with the answer to a result: it is leased as if it had been asked for.
TEST_F(ServerTest, TheNextJobComesWithTheAnswer) {
  auto server = start(socket());
  ASSERT_TRUE(server.ok()) << server.status();
  const auto address = *parse_address(socket());
  const auto sweep = frigate_sweep(2);
  ASSERT_TRUE(submit(address, sweep, {}, 1).ok());
  const auto farm = schema::Farm::NewStub(connect(address));
  schema::RegisterRequest request;
  request.set_worker_name("a");
  request.set_determinism_class(kSyntheticClass);
  request.set_physics_version(1);
  schema::RegisterReply registered;
  grpc::ClientContext first, second;
  ASSERT_TRUE(farm->Register(&first, request, &registered).ok());
  schema::LeaseRequest ask;
  ask.set_worker_id(registered.worker_id());
  schema::LeaseReply lease;
  ASSERT_TRUE(farm->Lease(&second, ask, &lease).ok());
  const auto returned = [&](const schema::LeaseReply& of, bool wants_job) {
    const auto bytes = synthetic_result(sweep, of.job()).SerializeAsString();
    grpc::ClientContext context;
    schema::CompleteReply reply;
    const auto stream = farm->Complete(&context, &reply);
    schema::CompleteChunk chunk;
    chunk.set_worker_id(registered.worker_id());
    chunk.set_fencing_token(of.fencing_token());
    chunk.set_sweep_sha256(of.job().sweep_sha256());
    chunk.set_wants_job(wants_job);
    chunk.set_result_bytes(bytes.size());
    chunk.set_piece(bytes);
    stream->Write(chunk);
    stream->WritesDone();
    EXPECT_TRUE(stream->Finish().ok());
    return reply;
  };
  const auto answer = returned(lease, true);
  EXPECT_EQ(answer.state(), schema::CompleteReply::STATE_STORED);
  ASSERT_EQ(answer.next().state(), schema::LeaseReply::STATE_LEASED);
  EXPECT_NE(answer.next().job().job_key(), lease.job().job_key());
  EXPECT_EQ(farm_status(address)->sweep(0).leased(), 1U);
  // The answer was lost: the same result again, and again a job, which is the same one.
  const auto again = returned(lease, true);
  EXPECT_EQ(again.state(), schema::CompleteReply::STATE_KNOWN);
  EXPECT_EQ(again.next().job().job_key(), answer.next().job().job_key());
  EXPECT_NE(again.next().fencing_token(), answer.next().fencing_token());
  EXPECT_EQ(farm_status(address)->sweep(0).leased(), 1U);
  EXPECT_FALSE(returned(again.next(), false).has_next());
  EXPECT_EQ(farm_status(address)->sweep(0).done(), 2U);
}

// Calls that nobody ends are cancelled; one that never began to be answered is no reason to wait.
TEST_F(ServerTest, AStreamThatNeverEndsDoesNotHoldUpTheEnd) {
  auto server = start(socket());
  ASSERT_TRUE(server.ok()) << server.status();
  const auto farm = schema::Farm::NewStub(connect(*parse_address(socket())));
  grpc::ClientContext submitting, completing;
  schema::SubmitReply submitted;
  const auto submission = farm->Submit(&submitting, &submitted);
  schema::SubmitChunk first;
  first.mutable_sweep()->set_size_bytes(1000);
  first.mutable_sweep()->set_physics_version(1);
  ASSERT_TRUE(submission->Write(first));
  schema::CompleteReply completed;
  const auto result = farm->Complete(&completing, &completed);
  schema::CompleteChunk piece;
  piece.set_worker_id("nobody");
  piece.set_result_bytes(1000);
  piece.set_piece("half");
  (void)result->Write(piece);  // refused at once: nobody has no lease
  const auto before = std::chrono::steady_clock::now();
  EXPECT_TRUE((*server)->stop().ok());  // without the end of these calls it would wait for ever
  RecordProperty(
      "seconds",
      std::to_string(
          std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count()));
  EXPECT_FALSE(submission->Finish().ok());
  EXPECT_FALSE(result->Finish().ok());
}

TEST_F(ServerTest, ADamagedModelIsRefused) {
  auto server = start(socket());
  ASSERT_TRUE(server.ok()) << server.status();
  auto sweep = frigate_sweep(1);
  sweep.set_model_sha256(sha256_hex("the model"));
  const auto address = *parse_address(socket());
  EXPECT_TRUE(absl::IsInvalidArgument(
      submit(address, sweep, model_alone(sweep, "another model"), 1).status()));
  EXPECT_EQ(farm_status(address)->sweep_size(), 0);
  EXPECT_TRUE(submit(address, sweep, model_alone(sweep, "the model"), 1).ok());
  const auto farm = schema::Farm::NewStub(connect(address));
  EXPECT_EQ(*fetch_file(*farm, sweep.model_sha256(), 5), "the model");
}

TEST_F(ServerTest, CancelByNameByHashAndByNothing) {
  auto server = start(socket());
  ASSERT_TRUE(server.ok()) << server.status();
  const auto address = *parse_address(socket());
  ASSERT_TRUE(submit(address, frigate_sweep(4), {}, 1).ok());
  const auto unknown = cancel(address, "no such sweep");
  EXPECT_TRUE(absl::IsNotFound(unknown.status()));
  EXPECT_THAT(std::string(unknown.status().message()), HasSubstr("frigate"));
  EXPECT_EQ(cancel(address, "frigate")->cancelled(), 4U);
  const auto sha = farm_status(address)->sweep(0).sweep_sha256();
  EXPECT_EQ(cancel(address, sha.substr(0, 10))->cancelled(), 0U);
}

TEST_F(ServerTest, PrioritiesByNameByHashAndWithASubmission) {
  auto server = start(socket());
  ASSERT_TRUE(server.ok()) << server.status();
  const auto address = *parse_address(socket());
  const auto priority = [&] { return farm_status(address)->sweep(0).priority(); };
  ASSERT_TRUE(submit(address, frigate_sweep(2), {}, 1, nullptr, 7).ok());
  EXPECT_EQ(priority(), 7);
  EXPECT_TRUE(prioritize(address, "frigate", -1000).ok());
  EXPECT_EQ(priority(), -1000);
  // Again, without a word of it.
  ASSERT_TRUE(submit(address, frigate_sweep(2), {}, 1).ok());
  EXPECT_EQ(priority(), -1000);
  EXPECT_TRUE(
      prioritize(address, farm_status(address)->sweep(0).sweep_sha256().substr(0, 10), 3).ok());
  EXPECT_EQ(priority(), 3);
  EXPECT_TRUE(absl::IsNotFound(prioritize(address, "no such sweep", 1)));
  for (const int beyond : {1001, -1001, 2'000'000'000, std::numeric_limits<int>::min()}) {
    EXPECT_TRUE(absl::IsInvalidArgument(prioritize(address, "frigate", beyond))) << beyond;
    EXPECT_TRUE(
        absl::IsInvalidArgument(submit(address, frigate_sweep(3), {}, 1, nullptr, beyond).status()))
        << beyond;
  }
  EXPECT_EQ(priority(), 3);
  EXPECT_EQ(farm_status(address)->sweep(0).jobs(), 2U);  // a refused submission changes nothing
}

TEST_F(ServerTest, APredictionThatNoPilotMakesIsRefusedWithItsSubmission) {
  auto server = start(socket());
  ASSERT_TRUE(server.ok()) << server.status();
  const auto address = *parse_address(socket());
  schema::Prediction good;
  good.set_made_unix_s(1.7e9);
  good.set_determinism_class("c");
  good.set_workers(2);
  good.set_pilot_viewpoints(3);
  good.set_pilot_cpu_s(1);
  good.set_jobs(2);
  good.set_cpu_s(4);
  good.set_wall_s(2);
  good.set_job_cpu_quartile1_s(1);
  good.set_job_cpu_median_s(2);
  good.set_job_cpu_quartile3_s(3);
  good.set_database_bytes(1000);
  const auto& reflection = *schema::Prediction::GetReflection();
  const auto& type = *schema::Prediction::descriptor();
  using Field = google::protobuf::FieldDescriptor;
  std::vector<schema::Prediction> wrong;
  for (int i = 0; i < type.field_count(); ++i) {
    const Field& field = *type.field(i);
    if (field.cpp_type() == Field::CPPTYPE_DOUBLE) {
      for (const double value :
           {-1.0, std::nan(""), std::numeric_limits<double>::infinity(), 1e300})
        reflection.SetDouble(&wrong.emplace_back(good), &field, value);
    } else if (field.cpp_type() == Field::CPPTYPE_UINT64) {
      for (const std::uint64_t value :
           {std::uint64_t{0}, std::numeric_limits<std::uint64_t>::max()})
        reflection.SetUInt64(&wrong.emplace_back(good), &field, value);
    } else {
      for (const char* value : {"a\nb", "\x1b]0;owned\x07"})
        reflection.SetString(&wrong.emplace_back(good), &field, value);
    }
  }
  wrong.emplace_back(good).set_job_cpu_median_s(3.5);
  wrong.emplace_back(good).set_job_cpu_quartile1_s(2.5);
  EXPECT_EQ(wrong.size(), 7U * 4 + 4 * 2 + 2 + 2);
  for (const schema::Prediction& prediction : wrong)
    EXPECT_TRUE(
        absl::IsInvalidArgument(submit(address, frigate_sweep(2), {}, 1, &prediction).status()))
        << prediction.ShortDebugString();
  EXPECT_EQ(farm_status(address)->sweep_size(), 0);
  EXPECT_TRUE(submit(address, frigate_sweep(2), {}, 1, &good).ok());
  EXPECT_EQ(farm_status(address)->sweep_size(), 1);
}

TEST_F(ServerTest, AWorkerOutlivesARestartOfTheCoordinator) {
  auto server = start(socket());
  ASSERT_TRUE(server.ok()) << server.status();
  ASSERT_TRUE(submit(*parse_address(socket()), frigate_sweep(20), {}, 1).ok());
  absl::Status ended = absl::UnknownError("still running");
  std::thread a([&] {
    SyntheticWork work;
    work.seconds = 0.05;
    ended = run_lease_loop(worker(socket(), "a"), synthetic_runner(work), stop_);
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  ASSERT_TRUE((*server)->stop().ok());
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  server = start(socket());
  EXPECT_TRUE(server.ok()) << server.status();
  a.join();
  EXPECT_TRUE(ended.ok()) << ended;
  EXPECT_EQ(farm_status(*parse_address(socket()))->sweep(0).done(), 20U);
}

TEST_F(ServerTest, AWorkerWithoutACoordinatorGivesUp) {
  auto plan = worker(socket(), "a");
  plan.give_up_after_s = 0.3;
  const auto status = run_lease_loop(plan, synthetic_runner({}), stop_);
  EXPECT_TRUE(absl::IsUnavailable(status));
  EXPECT_THAT(std::string(status.message()), HasSubstr("no coordinator answers at unix:"));
}

}  // namespace
}  // namespace irsig
