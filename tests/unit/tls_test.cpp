// Mutual TLS between coordinator, workers and clients, over real ports of the loopback interface,
// with certificates that the openssl program makes.
#include <gmock/gmock.h>
#include <grpcpp/client_context.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "absl/strings/str_cat.h"
#include "coordinator/client/certificate.h"
#include "coordinator/client/channel.h"
#include "coordinator/client/farm_client.h"
#include "coordinator/client/handshake.h"
#include "coordinator/farm_server.h"
#include "jobs/check_resolved.h"
#include "schema/farm.grpc.pb.h"
#include "tests/fault/synthetic_farm.h"
#include "worker/lease_loop.h"

namespace irsig {
namespace {

using testing::HasSubstr;

double tls_now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Two authorities; of the first a certificate for this machine, one that has expired, one that is
// not valid yet and one for another host; of the second one for this machine.
class Tls : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    std::string pattern = testing::TempDir() + "/irsig-tls-XXXXXX";
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    for (const char* ca : {"ca", "other"})
      openssl(absl::StrCat("req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 2 ",
                           "-subj /CN=", ca, " -keyout ", path(ca, "key"), " -out ",
                           path(ca, "pem")));
    make("here", "ca", "IP:127.0.0.1,DNS:localhost", "-days 2");
    make("elsewhere", "ca", "DNS:elsewhere.example", "-days 2");
    make("stranger", "other", "IP:127.0.0.1", "-days 2");
    make("expired", "ca", "IP:127.0.0.1", "-days -1");
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(folder_); }

  static std::string path(const std::string& name, const std::string& ending) {
    return absl::StrCat(folder_, "/", name, ".", ending);
  }
  static void openssl(const std::string& arguments) {
    const std::string command =
        absl::StrCat("openssl ", arguments, " >", folder_, "/log 2>&1 </dev/null");
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
  }
  static void make(const std::string& name, const std::string& ca, const std::string& hosts,
                   const std::string& days) {
    std::ofstream(path(name, "ext"))
        << "subjectAltName=" << hosts << "\nextendedKeyUsage=serverAuth,clientAuth,"
        << role_oid(Role::kSubmit) << "," << role_oid(Role::kWork) << "," << role_oid(Role::kRead)
        << "\n";
    openssl(absl::StrCat("req -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -subj /CN=", name,
                         " -keyout ", path(name, "key"), " -out ", path(name, "csr")));
    openssl(absl::StrCat("x509 -req -in ", path(name, "csr"), " -CA ", path(ca, "pem"), " -CAkey ",
                         path(ca, "key"), " -CAcreateserial ", days, " -extfile ",
                         path(name, "ext"), " -out ", path(name, "pem")));
    std::filesystem::permissions(path(name, "key"), std::filesystem::perms(0600));
  }
  static TlsFiles files(const std::string& name, const std::string& ca) {
    return {path(name, "pem"), path(name, "key"), path(ca, "pem")};
  }
  static Address insecure(const std::string& text) {
    return *parse_address(text, {.tls = {}, .insecure_loopback = true});
  }
  // The files are those of a user; the checks of read_tls, which come before all of this, are left
  // out.
  static Address address(const std::string& text, const std::string& name, const std::string& ca) {
    Address out = insecure(text);
    const auto bytes = [](const std::string& file) {
      std::ifstream in(file);
      return std::string(std::istreambuf_iterator<char>(in), {});
    };
    out.tls = std::make_shared<const TlsIdentity>(
        TlsIdentity{bytes(path(name, "pem")), bytes(path(name, "key")), bytes(path(ca, "pem"))});
    return out;
  }

  std::unique_ptr<FarmServer> start(const Address& listen) {
    auto server = FarmServer::start({absl::StrCat(folder_, "/", ++databases_, ".sigdb"),
                                     listen,
                                     {1, 60, 5},
                                     tls_now_s,
                                     tls_now_s,
                                     [](const absl::Status& status) { ADD_FAILURE() << status; },
                                     check_resolved});
    EXPECT_TRUE(server.ok()) << server.status();
    return server.ok() ? *std::move(server) : nullptr;
  }

  static inline std::string folder_;
  static inline int databases_ = 0;
};

TEST_F(Tls, ASweepIsSubmittedComputedAndAskedForOverIt) {
  const auto listen = parse_address("127.0.0.1:0", {.tls = files("here", "ca")});
  ASSERT_TRUE(listen.ok()) << listen.status();
  const auto server = start(*listen);
  ASSERT_TRUE(server);
  const std::string port = server->address().substr(server->address().rfind(':'));
  // A certificate names the host as it is typed.
  for (const std::string& host : {std::string("127.0.0.1"), std::string("localhost")}) {
    const auto there = parse_address(host + port, {.tls = files("here", "ca")});
    ASSERT_TRUE(there.ok()) << there.status();
    ASSERT_TRUE(submit(*there, frigate_sweep(3), {}, 1).ok()) << host;
    EXPECT_TRUE(check_handshake(*there).ok()) << check_handshake(*there);
    WorkerPlan plan;
    plan.coordinator = *there;
    plan.worker_name = "a";
    plan.determinism_class = kSyntheticClass;
    plan.physics_version = 1;
    plan.exit_when_finished = true;
    plan.give_up_after_s = 20;
    const std::atomic<bool> stop = false;
    const absl::Status worked = run_lease_loop(plan, synthetic_runner({}), stop);
    EXPECT_TRUE(worked.ok()) << worked;
    const auto status = farm_status(*there);
    ASSERT_TRUE(status.ok()) << status.status();
    EXPECT_EQ(status->sweep(0).done(), 3U);
  }
  EXPECT_TRUE(server->stop().ok());
}

// A refused client is told why, by commands and by workers, and at once.
TEST_F(Tls, WhoIsRefusedIsToldWhy) {
  const auto server = start(address("127.0.0.1:0", "here", "ca"));
  ASSERT_TRUE(server);
  const std::string text = server->address();
  const Address plain = insecure(text);
  struct Case {
    Address address;
    std::string why;
  };
  const std::vector<Case> cases = {
      {plain, "speaks TLS only: give --tls-cert, --tls-key and --tls-ca"},
      {address(text, "stranger", "ca"), "does not accept our certificate"},
      {address(text, "expired", "ca"), "does not accept our certificate"},
      {address(text, "here", "other"), "shows a certificate that is not accepted"},
  };
  for (const Case& refused : cases) {
    const absl::Status asked = farm_status(refused.address).status();
    EXPECT_TRUE(absl::IsFailedPrecondition(asked)) << refused.why << ": " << asked;
    EXPECT_THAT(std::string(asked.message()), HasSubstr(refused.why));
    // No call gets through, whatever the client says of itself.
    const auto farm = schema::Farm::NewStub(connect(refused.address));
    grpc::ClientContext context;
    schema::StatusReply reply;
    EXPECT_EQ(farm->Status(&context, schema::StatusRequest(), &reply).error_code(),
              grpc::StatusCode::UNAVAILABLE);
    WorkerPlan plan;
    plan.coordinator = refused.address;
    plan.worker_name = "a";
    plan.determinism_class = kSyntheticClass;
    plan.physics_version = 1;
    plan.give_up_after_s = 20;
    const std::atomic<bool> stop = false;
    const absl::Status worked = run_lease_loop(plan, synthetic_runner({}), stop);
    EXPECT_TRUE(absl::IsFailedPrecondition(worked)) << worked;
    EXPECT_THAT(std::string(worked.message()), HasSubstr(refused.why));
  }
  EXPECT_TRUE(farm_status(address(text, "here", "ca")).ok()) << "it goes on";
  EXPECT_TRUE(server->stop().ok());
}

TEST_F(Tls, ACoordinatorThatIsNotWhatItShouldBeIsRefused) {
  for (const auto& [name, why] :
       {std::pair<std::string, std::string>{"expired", "certificate has expired"},
        {"elsewhere", "mismatch"},
        {"stranger", "unable to get local issuer certificate"}}) {
    const auto server = start(address("127.0.0.1:0", name, "ca"));
    ASSERT_TRUE(server);
    const absl::Status asked = farm_status(address(server->address(), "here", "ca")).status();
    EXPECT_THAT(std::string(asked.message()), HasSubstr(why)) << name;
    EXPECT_THAT(std::string(asked.message()),
                HasSubstr("shows a certificate that is not accepted"));
    EXPECT_TRUE(server->stop().ok());
  }
  const auto plain = start(insecure("127.0.0.1:0"));
  ASSERT_TRUE(plain);
  EXPECT_THAT(std::string(farm_status(address(plain->address(), "here", "ca")).status().message()),
              HasSubstr("does not speak TLS: start it with"));
  // Nobody is there: nothing is wrong with a certificate.
  const std::string gone = plain->address();
  EXPECT_TRUE(plain->stop().ok());
  EXPECT_TRUE(absl::IsUnavailable(farm_status(address(gone, "here", "ca")).status()));
}

TEST_F(Tls, FilesThatCannotServeAreRefusedByName) {
  std::ofstream(path("text", "pem")) << "no certificate\n";
  std::ofstream(path("text", "key")) << "no key\n";
  std::filesystem::permissions(path("text", "key"), std::filesystem::perms(0600));
  std::filesystem::copy_file(path("here", "key"), path("open", "key"));
  std::filesystem::permissions(path("open", "key"), std::filesystem::perms(0640));
  openssl(absl::StrCat("ec -aes256 -passout pass:secret -in ", path("here", "key"), " -out ",
                       path("locked", "key")));
  std::filesystem::permissions(path("locked", "key"), std::filesystem::perms(0600));
  const std::string here = path("here", "pem"), key = path("here", "key"), ca = path("ca", "pem");
  struct Case {
    TlsFiles files;
    std::string why;
  };
  const std::vector<Case> cases = {
      {{here, key, ""}, "--tls-ca is missing"},
      {{here, "", ca}, "--tls-key is missing"},
      {{"", key, ca}, "--tls-cert is missing"},
      {{path("none", "pem"), key, ca}, "none.pem: "},
      {{path("text", "pem"), key, ca}, "text.pem: has no certificate"},
      {{here, key, path("text", "pem")}, "text.pem: has no certificate"},
      {{here, path("text", "key"), ca}, "text.key: has no private key"},
      {{here, path("locked", "key"), ca},
       "locked.key: has no private key, expected one in PEM "
       "without a password"},
      {{here, path("open", "key"), ca}, "open.key: a private key that others may use (mode 0640)"},
      {{here, path("elsewhere", "key"), ca}, "elsewhere.key: is not the key of the certificate in"},
      {{path("expired", "pem"), path("expired", "key"), ca}, "expired.pem: the certificate has"},
      {{path("stranger", "pem"), path("stranger", "key"), ca},
       "stranger.pem: not signed by the authority in"},
  };
  ASSERT_TRUE(read_tls({here, key, ca}).ok()) << read_tls({here, key, ca}).status();
  for (const Case& wrong : cases) {
    const absl::Status status = parse_address("127.0.0.1:7", {.tls = wrong.files}).status();
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << wrong.why << ": " << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(wrong.why));
  }
  const auto refused = [&](const char* text, bool of_loopback, bool of_network) {
    return std::string(
        parse_address(text, {{here, key, ca}, of_loopback, of_network}).status().message());
  };
  EXPECT_THAT(refused("unix:/run/x", false, false), HasSubstr("TLS is for ports"));
  EXPECT_THAT(refused("10.1.2.3:4", false, true),
              HasSubstr("--insecure-network is for addresses without"));
  EXPECT_THAT(refused("127.0.0.1:4", true, false),
              HasSubstr("--insecure-loopback is for addresses without"));
  EXPECT_EQ(refused("10.1.2.3:4", false, false), "");
}

}  // namespace
}  // namespace irsig
