#pragma once

#include <grpcpp/server_builder.h>

#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/statusor.h"
#include "coordinator/once_a_second.h"

namespace irsig {

// Takes the connections of a port and hands them to a gRPC server. gRPC's own listener gives up for
// ever at the first connection for which there is no file descriptor; this one turns the last ones
// away, and goes on: the database needs some, too. Belongs to one thread.
class FrontGate {
 public:
  // More than the usual 1024, as far as the hard limit of this process allows.
  static void raise_open_files();

  // Holds the port (0: any free one) of an IPv4 address, an [IPv6] one or a name: "HOST:PORT".
  // ALREADY_EXISTS: another process has it; INVALID_ARGUMENT: the host is none of this machine's.
  static absl::StatusOr<std::unique_ptr<FrontGate>> open(const std::string& host_port);
  ~FrontGate() { stop(); }
  FrontGate(const FrontGate&) = delete;
  FrontGate& operator=(const FrontGate&) = delete;

  [[nodiscard]] int port() const { return port_; }
  // From here on, until stop(); the server must have started, and be stopped later.
  void start(std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> server);
  void stop();

 private:
  FrontGate() = default;
  void run();
  void take(int listening);

  std::vector<int> listening_;
  int port_ = 0;
  int most_fd_ = 0;  // a connection with a higher number is turned away
  int wake_ = -1;
  OnceASecond waiting_, refused_;
  std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> server_;
  std::thread thread_;
};

}  // namespace irsig
