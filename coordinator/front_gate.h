#pragma once

#include <grpcpp/server_builder.h>

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "coordinator/client/address.h"
#include "coordinator/visitors.h"

namespace irsig {

// Stands in front of a gRPC server: takes the connections of an address, ends their TLS, counts
// what their clients ask for (frame_meter.h) and carries the bytes on (relay.h). gRPC's own
// listener gives up for ever at the first connection for which there is no file descriptor; this
// one turns the last ones away, and goes on: the database needs some, too. Belongs to one thread.
class FrontGate {
 public:
  // Raises the limit of open files from the usual 1024 to the hard limit of this process.
  static void raise_open_files();

  // Holds the address: the port (0: any free one) of an IPv4 address, an [IPv6] one or a name, or a
  // Unix socket of mode 0600, which replaces a file at its path.
  // ALREADY_EXISTS: another process has it; INVALID_ARGUMENT: the host is none of this machine's.
  static absl::StatusOr<std::unique_ptr<FrontGate>> open(const Address& address,
                                                         Visitors& visitors);
  virtual ~FrontGate() = default;

  [[nodiscard]] virtual int port() const = 0;
  // Connections that say nothing for so long are put out. The server must have started.
  virtual void start(std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> server,
                     int patience_ms) = 0;
  // Refuses further connections; existing ones continue.
  virtual void close_door() = 0;
  // Sends the server's last bytes and ends. Call it after the server has shut down.
  virtual void stop() = 0;
};

}  // namespace irsig
