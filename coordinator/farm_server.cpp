#include "coordinator/farm_server.h"

#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <optional>
#include <random>

#include "absl/strings/str_cat.h"
#include "coordinator/client/channel.h"
#include "coordinator/commit_loop.h"
#include "coordinator/farm_service.h"
#include "coordinator/front_gate.h"
#include "coordinator/visitors.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

// From the connection to the first words of HTTP/2. Clients give up after kConnectTimeoutMs.
constexpr int kHandshakeMs = 2 * kConnectTimeoutMs;
// Streams per connection, as announced to its client. The gate closes a connection at a few more
// (FrameLimits).
constexpr int kMostStreams = 16;
constexpr auto kLastCalls = std::chrono::seconds(2);  // for calls under way when the server stops

absl::Status in_use(const Address& listen) {
  return absl::AlreadyExistsError(
      absl::StrCat("cannot listen on ", listen.text, ": another process listens there"));
}

// gRPC removes whatever lies at the path of a Unix socket, even one that is in use: look first.
absl::Status prepare_socket(const Address& listen) {
  const std::filesystem::path path = listen.unix_path;
  struct stat folder {};
  if (stat(path.parent_path().c_str(), &folder) != 0) {
    return absl::InvalidArgumentError(
        absl::StrCat("cannot listen on ", listen.text, ": ", std::strerror(errno)));
  }
  if ((folder.st_mode & (S_IWGRP | S_IWOTH)) != 0 && (folder.st_mode & S_ISVTX) == 0) {
    return absl::InvalidArgumentError(absl::StrCat(
        "cannot listen on ", listen.text,
        ": others may write to its folder and could replace the socket; use a private folder"));
  }
  struct stat there {};
  if (lstat(path.c_str(), &there) != 0) return absl::OkStatus();
  if (!S_ISSOCK(there.st_mode)) {
    return absl::InvalidArgumentError(
        absl::StrCat("cannot listen on ", listen.text, ": a file that is no socket lies there"));
  }
  const int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (probe < 0) return absl::InternalError(std::strerror(errno));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  listen.unix_path.copy(address.sun_path, sizeof(address.sun_path) - 1);
  const bool answered =
      connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  close(probe);
  return answered ? in_use(listen) : absl::OkStatus();
}

std::string folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

std::string random_id() {
  std::random_device device;
  return absl::StrCat(absl::Hex(device(), absl::kZeroPad8), absl::Hex(device(), absl::kZeroPad8));
}

class Server final : public FarmServer {
 public:
  explicit Server(FarmServerOptions options)
      : options_(std::move(options)),
        service_(loop_, folder_of(options_.db_path), options_.check_sweep),
        address_(options_.listen.text) {}

  ~Server() override { (void)stop(); }

  absl::Status start() {
    ASSIGN_OR_RETURN(door_, Doorkeeper::make(options_.listen.tls, visitors_, options_.tls_crl,
                                             options_.unix_clock));
    ASSIGN_OR_RETURN(store_, StoreWriter::open(options_.db_path));
    RETURN_IF_ERROR(take_over());
    farm_.emplace(*store_, options_.rules, options_.clock, options_.unix_clock, random_id(),
                  options_.check_sweep);
    service_.use(farm_->leases(), *door_);
    loop_.start(*farm_, *store_, [this](absl::Status status) {
      failed_ = true;
      if (options_.on_failure) options_.on_failure(status);
    });
    auto bound = bind();
    if (!bound.ok()) options_.remove_unused = true;
    return bound;
  }

  [[nodiscard]] std::string address() const override { return address_; }

  absl::Status stop() override {
    service_.stop();
    if (gate_) gate_->close_door();
    if (server_) server_->Shutdown(std::chrono::system_clock::now() + kLastCalls);
    loop_.stop();
    if (gate_) gate_->stop();
    server_.reset();
    gate_.reset();
    if (!options_.listen.unix_path.empty() && bound_) unlink(options_.listen.unix_path.c_str());
    bound_ = false;
    absl::Status status;
    if (store_ && !failed_) status = finish();
    farm_.reset();
    store_.reset();
    return status;
  }

 private:
  absl::Status take_over() {
    RETURN_IF_ERROR(store_->begin());
    RETURN_IF_ERROR(store_->release_all());
    ASSIGN_OR_RETURN(const auto damaged, store_->reopen_damaged());
    if (damaged > 0)
      log_line(LogLevel::warn, {}, "{} heat jobs wait again: their stored temperatures are damaged",
               damaged);
    return store_->commit();
  }

  absl::Status finish() {
    if (options_.remove_unused) {
      ASSIGN_OR_RETURN(const auto removed, store_->remove_if_unused());
      if (removed) return absl::OkStatus();
    }
    return store_->finish();
  }

  absl::Status bind() {
    const Address& listen = options_.listen;
    if (!listen.unix_path.empty()) {
      RETURN_IF_ERROR(prepare_socket(listen));
    }
    silence_grpc();
    auto gate = FrontGate::open(listen, visitors_);
    if (absl::IsAlreadyExists(gate.status())) return in_use(listen);
    if (!gate.ok())
      return absl::InvalidArgumentError(
          absl::StrCat("cannot listen on ", listen.text, ": ", gate.status().message()));
    bound_ = true;
    grpc::ServerBuilder builder;
    // Each connection keeps what it had to read at once, up to 4 MB: a thousand of them, much.
    builder.AddChannelArgument(GRPC_ARG_TCP_MAX_READ_CHUNK_SIZE, 16 << 10);
    builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveMs);
    builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveTimeoutMs);
    builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
    builder.AddChannelArgument(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
    // Workers ping every kKeepaliveMs; without this the server takes that for an attack (GOAWAY).
    builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS,
                               kKeepaliveMs / 4);
    builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, kHandshakeMs);
    builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, kMostStreams);
    // Nobody of ours compresses, and a limit of what arrives would be none of what it inflates to.
    for (const auto how : {GRPC_COMPRESS_DEFLATE, GRPC_COMPRESS_GZIP})
      builder.SetCompressionAlgorithmSupportStatus(how, false);
    builder.SetMaxReceiveMessageSize(kMaxRequestBytes);
    builder.SetMaxSendMessageSize(kMaxMessageBytes);
    builder.RegisterService(&service_);
    // Sockets of this process alone: the gate has ended TLS, and knows who is at the other end.
    auto connections = builder.experimental().AddExternalConnectionAcceptor(
        grpc::ServerBuilder::experimental_type::ExternalConnectionType::FROM_FD,
        grpc::InsecureServerCredentials());
    server_ = builder.BuildAndStart();
    if (!server_) return absl::InternalError("no server could be started");
    gate_ = *std::move(gate);
    gate_->start(std::move(connections), kHandshakeMs);
    if (listen.unix_path.empty()) {
      const std::string place = listen.target.substr(listen.target.find(':') + 1);
      address_ = absl::StrCat(place.substr(0, place.rfind(':')), ":", gate_->port());
    }
    return absl::OkStatus();
  }

  FarmServerOptions options_;
  CommitLoop loop_;
  Visitors visitors_;
  std::unique_ptr<Doorkeeper> door_;
  FarmService service_;
  std::string address_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<FrontGate> gate_;
  bool bound_ = false;
  std::atomic<bool> failed_ = false;
  std::unique_ptr<StoreWriter> store_;
  std::optional<Farm> farm_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<FarmServer>> FarmServer::start(FarmServerOptions options) {
  if (!options.check_sweep) return absl::InternalError("a coordinator has no check of sweeps");
  auto server = std::make_unique<Server>(std::move(options));
  RETURN_IF_ERROR(server->start());
  return server;
}

}  // namespace irsig
