// Certificates of `irsig ca` and what they open: every call with every role, over real TLS; what is
// revoked or expires while a coordinator runs.
#include <gmock/gmock.h>
#include <grpcpp/client_context.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "absl/strings/str_cat.h"
#include "coordinator/client/authority.h"
#include "coordinator/client/channel.h"
#include "coordinator/client/farm_client.h"
#include "coordinator/farm_server.h"
#include "jobs/check_resolved.h"
#include "schema/farm.grpc.pb.h"
#include "spdlog/sinks/ostream_sink.h"
#include "spdlog/spdlog.h"
#include "tests/fault/synthetic_farm.h"
#include "worker/lease_loop.h"

namespace irsig {
namespace {

using testing::HasSubstr;

constexpr double kDay_s = 86400;

double unix_now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

class Roles : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "/irsig-roles-XXXXXX";
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    ASSERT_TRUE(make_authority(ca(), "a farm", unix_now_s(), 100 * kDay_s).ok());
    issue("here", {"127.0.0.1"}, {});
    before_ = spdlog::default_logger();
    spdlog::set_default_logger(std::make_shared<spdlog::logger>(
        "roles", std::make_shared<spdlog::sinks::ostream_sink_mt>(log_)));
  }
  void TearDown() override {
    if (server_) {
      EXPECT_TRUE(server_->stop().ok());
    }
    spdlog::set_default_logger(before_);
    std::filesystem::remove_all(folder_);
  }

  [[nodiscard]] std::string ca() const { return folder_ + "/ca"; }
  [[nodiscard]] std::string path(const std::string& file) const { return folder_ + "/" + file; }
  void issue(const std::string& name, std::vector<std::string> hosts, std::set<Role> roles,
             double days = 30) {
    const absl::Status issued = issue_certificate(ca(), {name, std::move(hosts), std::move(roles)},
                                                  folder_, unix_now_s(), days * kDay_s);
    ASSERT_TRUE(issued.ok()) << issued;
  }
  [[nodiscard]] Address address(const std::string& text, const std::string& name) const {
    const auto out =
        parse_address(text, {.tls = {path(name + ".pem"), path(name + ".key"), ca() + "/ca.pem"}});
    EXPECT_TRUE(out.ok()) << out.status();
    return *out;
  }
  void start() {
    auto server = FarmServer::start(
        {.db_path = path("test.sigdb"),
         .listen = address("127.0.0.1:0", "here"),
         .rules = {1, 60, 5},
         .clock = unix_now_s,
         .unix_clock = [this] { return unix_now_s() + later_s_; },
         .on_failure = [](const absl::Status& status) { ADD_FAILURE() << status; },
         .check_sweep = check_resolved,
         .tls_crl = ca() + "/crl.pem"});
    ASSERT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
  }
  // Returns the answer of each call to the holder of this certificate.
  std::map<std::string, absl::StatusCode> all_calls(const std::string& name) {
    const auto farm = schema::Farm::NewStub(connect(address(server_->address(), name)));
    std::map<std::string, absl::StatusCode> out;
    const auto unary = [&](const char* call, auto ask) {
      grpc::ClientContext context;
      out[call] = to_absl(ask(&context)).code();
    };
    schema::RegisterReply registered;
    schema::LeaseReply lease;
    schema::HeartbeatReply heartbeat;
    schema::FailReply failed;
    schema::StatusReply status;
    schema::CancelReply cancelled;
    schema::PrioritizeReply prioritized;
    schema::SubmitReply submitted;
    schema::CompleteReply completed;
    unary("Register", [&](auto* c) { return farm->Register(c, {}, &registered); });
    unary("Lease", [&](auto* c) { return farm->Lease(c, {}, &lease); });
    unary("Heartbeat", [&](auto* c) { return farm->Heartbeat(c, {}, &heartbeat); });
    unary("Fail", [&](auto* c) { return farm->Fail(c, {}, &failed); });
    unary("Status", [&](auto* c) { return farm->Status(c, {}, &status); });
    unary("Cancel", [&](auto* c) { return farm->Cancel(c, {}, &cancelled); });
    unary("Prioritize", [&](auto* c) { return farm->Prioritize(c, {}, &prioritized); });
    unary("Submit", [&](auto* c) {
      const auto stream = farm->Submit(c, &submitted);
      stream->WritesDone();
      return stream->Finish();
    });
    unary("Complete", [&](auto* c) {
      const auto stream = farm->Complete(c, &completed);
      stream->WritesDone();
      return stream->Finish();
    });
    unary("FetchAsset", [&](auto* c) { return farm->FetchAsset(c, {})->Finish(); });
    return out;
  }

  std::string folder_;
  std::atomic<double> later_s_ = 0;  // the coordinator's date is so much later
  std::unique_ptr<FarmServer> server_;
  std::shared_ptr<spdlog::logger> before_;
  std::ostringstream log_;
};

TEST_F(Roles, EachCallNeedsItsOwn) {
  start();
  const std::map<std::string, std::set<Role>> enough = {{"Register", {Role::kWork}},
                                                        {"Lease", {Role::kWork}},
                                                        {"Heartbeat", {Role::kWork}},
                                                        {"Fail", {Role::kWork}},
                                                        {"Complete", {Role::kWork}},
                                                        {"Submit", {Role::kSubmit}},
                                                        {"Cancel", {Role::kSubmit}},
                                                        {"Prioritize", {Role::kSubmit}},
                                                        {"Status", {Role::kSubmit, Role::kRead}},
                                                        {"FetchAsset", {Role::kWork, Role::kRead}}};
  // Every call of the service, so that a new one needs a line above.
  ASSERT_EQ(static_cast<int>(enough.size()),
            schema::SubmitReply::descriptor()->file()->FindServiceByName("Farm")->method_count());
  for (unsigned which = 0; which < 8; ++which) {
    std::set<Role> roles;
    for (const Role role : kRoles)
      if ((which >> static_cast<unsigned>(role) & 1U) != 0) roles.insert(role);
    const std::string name = absl::StrCat("who", which);
    // A certificate without a role is a coordinator's, and the handshake refuses it.
    if (roles.empty()) continue;
    issue(name, {}, roles);
    for (const auto& [call, code] : all_calls(name)) {
      bool may = false;
      for (const Role role : roles) may = may || enough.at(call).contains(role);
      EXPECT_EQ(code == absl::StatusCode::kPermissionDenied, !may)
          << call << " with " << role_list(roles, "and") << ": " << code;
      EXPECT_NE(code, absl::StatusCode::kUnauthenticated) << call;
    }
  }
  const absl::Status refused =
      submit(address(server_->address(), "who2"), frigate_sweep(1), {}, 1).status();
  EXPECT_EQ(refused.message(), "Submit needs the role submit; the certificate \"who2\" has work");
  EXPECT_THAT(log_.str(), HasSubstr("refused: Status by \"who2\" (certificate "));
  EXPECT_THAT(log_.str(), HasSubstr("from 127.0.0.1:"));
}

// A sweep by three people: one submits, one computes, one looks.
TEST_F(Roles, ASweepByThreeCertificates) {
  start();
  issue("user", {}, {Role::kSubmit});
  issue("worker", {}, {Role::kWork});
  issue("reader", {}, {Role::kRead});
  ASSERT_TRUE(submit(address(server_->address(), "user"), frigate_sweep(3), {}, 1).ok());
  WorkerPlan plan;
  plan.coordinator = address(server_->address(), "worker");
  plan.worker_name = "a";
  plan.determinism_class = kSyntheticClass;
  plan.physics_version = 1;
  plan.exit_when_finished = true;
  const std::atomic<bool> stop = false;
  const absl::Status worked = run_lease_loop(plan, synthetic_runner({}), stop);
  EXPECT_TRUE(worked.ok()) << worked;
  const auto seen = farm_status(address(server_->address(), "reader"));
  ASSERT_TRUE(seen.ok()) << seen.status();
  EXPECT_EQ(seen->sweep(0).done(), 3U);
  // A worker that may not work ends with the reason, and does not try for ever.
  plan.coordinator = address(server_->address(), "reader");
  const absl::Status refused = run_lease_loop(plan, synthetic_runner({}), stop);
  EXPECT_TRUE(absl::IsPermissionDenied(refused)) << refused;
  EXPECT_THAT(std::string(refused.message()), HasSubstr("needs the role work"));
}

TEST_F(Roles, WhatIsRevokedIsRefusedByARunningCoordinator) {
  issue("user", {}, {Role::kRead});
  issue("other", {}, {Role::kRead});
  start();
  // The connection stays, and the certificate is asked for with every call.
  const auto farm = schema::Farm::NewStub(connect(address(server_->address(), "user")));
  const auto ask = [&] {
    grpc::ClientContext context;
    schema::StatusReply reply;
    return to_absl(farm->Status(&context, schema::StatusRequest(), &reply));
  };
  EXPECT_TRUE(ask().ok());
  const auto revoked = revoke_certificates(ca(), "user", unix_now_s());
  ASSERT_TRUE(revoked.ok()) << revoked.status();
  EXPECT_EQ(*revoked, 1U);
  later_s_ = later_s_ + 2;  // it looks once a second
  const absl::Status refused = ask();
  EXPECT_TRUE(absl::IsUnauthenticated(refused)) << refused;
  EXPECT_THAT(std::string(refused.message()), HasSubstr("\"user\" was revoked"));
  EXPECT_THAT(log_.str(), HasSubstr("read anew: 1 in"));
  const Address other = address(server_->address(), "other");
  EXPECT_TRUE(farm_status(other).ok()) << "the others go on";
  // A list that is damaged, or somebody else's, does not let the revoked in again; status says so.
  ASSERT_TRUE(make_authority(path("stranger"), "another farm", unix_now_s(), kDay_s).ok());
  std::filesystem::copy_file(path("stranger/crl.pem"), ca() + "/crl.pem",
                             std::filesystem::copy_options::overwrite_existing);
  later_s_ = later_s_ + 2;
  EXPECT_TRUE(absl::IsUnauthenticated(ask()));
  const auto status = farm_status(other);
  ASSERT_TRUE(status.ok()) << status.status();
  ASSERT_EQ(status->warning_size(), 1);
  EXPECT_THAT(status->warning(0), HasSubstr("is no revocation list of the authority"));
}

TEST_F(Roles, WhatRunsOutIsSaidBeforeAndRefusedAfter) {
  issue("user", {}, {Role::kRead}, 20);
  start();
  const Address user = address(server_->address(), "user");
  const auto farm = schema::Farm::NewStub(connect(user));
  const auto ask = [&] {
    grpc::ClientContext context;
    schema::StatusReply reply;
    const absl::Status status = to_absl(farm->Status(&context, schema::StatusRequest(), &reply));
    return status.ok() ? absl::StatusOr<schema::StatusReply>(reply) : status;
  };
  EXPECT_EQ(ask()->warning_size(), 0);
  later_s_ = 18.5 * kDay_s;  // less than a tenth of 20 days is left
  const auto soon = ask();
  ASSERT_TRUE(soon.ok()) << soon.status();
  ASSERT_EQ(soon->warning_size(), 1);
  EXPECT_EQ(soon->warning(0), "the certificate \"user\" of a caller expires in 1 day");
  EXPECT_THAT(log_.str(), HasSubstr("expires in 1 day"));
  later_s_ = 20.5 * kDay_s;
  const absl::Status expired = ask().status();
  EXPECT_TRUE(absl::IsUnauthenticated(expired)) << expired;
  EXPECT_THAT(std::string(expired.message()), HasSubstr("has expired"));
  // The coordinator's own (30 days) and the authority's (100).
  issue("late", {}, {Role::kRead}, 90);
  later_s_ = 29.5 * kDay_s;
  const auto own = farm_status(address(server_->address(), "late"));
  ASSERT_TRUE(own.ok()) << own.status();
  ASSERT_EQ(own->warning_size(), 1);
  EXPECT_EQ(own->warning(0), "the certificate \"here\" expires in 11 hours");
}

// A key purpose is for one end of a connection.
TEST_F(Roles, ACoordinatorIsNoUserAndAUserNoCoordinator) {
  issue("user", {}, {Role::kRead, Role::kWork, Role::kSubmit});
  start();
  EXPECT_FALSE(farm_status(address(server_->address(), "here"), 3).ok());
  auto server = FarmServer::start({.db_path = path("false.sigdb"),
                                   .listen = address("127.0.0.1:0", "user"),
                                   .rules = {1, 60, 5},
                                   .clock = unix_now_s,
                                   .unix_clock = unix_now_s,
                                   .on_failure = nullptr,
                                   .check_sweep = check_resolved});
  ASSERT_TRUE(server.ok()) << server.status();
  const absl::Status refused = farm_status(address((*server)->address(), "user"), 3).status();
  EXPECT_THAT(std::string(refused.message()), HasSubstr("not accepted"));
  EXPECT_TRUE((*server)->stop().ok());
}

TEST_F(Roles, WhatAnAuthorityRefusesToSign) {
  const auto refused = [&](const CertificateWish& wish, double days = 1) {
    const absl::Status status = issue_certificate(ca(), wish, folder_, unix_now_s(), days * kDay_s);
    EXPECT_TRUE(absl::IsInvalidArgument(status) || absl::IsAlreadyExists(status)) << status;
    return std::string(status.message());
  };
  for (const std::string& name :
       {std::string(), std::string("../x"), std::string("a b"), std::string("-x"),
        std::string(".x"), std::string(65, 'x'), std::string("ca"), std::string("x\n")})
    EXPECT_THAT(refused({name, {}, {Role::kRead}}), HasSubstr("name \"")) << name;
  for (const std::string& host :
       {std::string(), std::string("*.example"), std::string("a..b"), std::string("-a"),
        std::string("a,DNS:b"), std::string("300.1.1.1"), std::string("a_b"), std::string("[::1]"),
        std::string(64, 'a'), std::string("a\nb")})
    EXPECT_THAT(refused({"x", {host}, {}}), HasSubstr("host \"")) << host;
  EXPECT_THAT(refused({"x", {}, {}}), HasSubstr("--host"));
  EXPECT_THAT(refused({"x", {}, {Role::kRead}}, 200), HasSubstr("would outlive"));
  issue("x", {"node7", "10.1.2.3", "::1", "a.b-c.example"}, {Role::kRead, Role::kWork});
  EXPECT_THAT(refused({"x", {}, {Role::kRead}}), HasSubstr("x.pem is there already"));
  EXPECT_TRUE(absl::IsAlreadyExists(make_authority(ca(), "again", unix_now_s(), kDay_s)));
  EXPECT_TRUE(absl::IsNotFound(revoke_certificates(ca(), "nobody", unix_now_s()).status()));
  struct stat there {};
  for (const std::string& key : {path("x.key"), ca() + "/ca.key"}) {
    ASSERT_EQ(stat(key.c_str(), &there), 0);
    EXPECT_EQ(there.st_mode & 0777, 0600U);
  }
  ASSERT_EQ(stat(ca().c_str(), &there), 0);
  EXPECT_EQ(there.st_mode & 0777, 0700U);
  // Every certificate is known to its authority, those of which nothing else is left, too.
  const auto issued = issued_certificates(ca());
  ASSERT_TRUE(issued.ok()) << issued.status();
  ASSERT_EQ(issued->size(), 2U);
  EXPECT_TRUE((*issued)[0].facts.of_a_server);
  EXPECT_EQ((*issued)[1].facts.roles, (std::set<Role>{Role::kRead, Role::kWork}));
  EXPECT_EQ(*revoke_certificates(ca(), (*issued)[1].facts.serial_hex, unix_now_s()), 1U);
  EXPECT_EQ(*revoke_certificates(ca(), "x", unix_now_s()), 0U);
  EXPECT_EQ(*revoke_certificates(ca(), "here", unix_now_s()), 1U);
  const auto after = issued_certificates(ca());
  ASSERT_TRUE(after.ok()) << after.status();
  for (const auto& one : *after) EXPECT_TRUE(one.revoked) << one.facts.name;
  // The openssl program judges them with its own rules.
  const auto openssl = [&](const std::string& arguments) {
    return std::system(absl::StrCat("openssl ", arguments, " >", path("log"), " 2>&1").c_str());
  };
  const std::string chain = absl::StrCat("verify -x509_strict -CAfile ", ca(), "/ca.pem ");
  EXPECT_EQ(openssl(absl::StrCat(chain, "-purpose sslclient ", path("x.pem"))), 0);
  EXPECT_EQ(openssl(absl::StrCat(chain, "-verify_hostname node7 ", path("x.pem"))), 0);
  EXPECT_NE(openssl(absl::StrCat(chain, "-verify_hostname node8 ", path("x.pem"))), 0);
  EXPECT_NE(openssl(absl::StrCat(chain, "-purpose sslclient ", path("here.pem"))), 0);
  EXPECT_NE(openssl(absl::StrCat(chain, "-crl_check -CRLfile ", ca(), "/crl.pem ", path("x.pem"))),
            0);
}

}  // namespace
}  // namespace irsig
