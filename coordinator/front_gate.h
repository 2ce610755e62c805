#pragma once

#include <grpcpp/server_builder.h>

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "coordinator/client/address.h"
#include "coordinator/visitors.h"

namespace irsig {

// Accepts the connections of an address before a gRPC server, ends their TLS, counts the clients'
// requests (frame_meter.h) and forwards the bytes (relay.h). gRPC's own listener stops for ever at
// the first connection without a free file descriptor. This one refuses connections before that and
// continues, because the database needs descriptors, too. Belongs to one thread.
class FrontGate {
 public:
  // Raises the limit of open files from the usual 1024 to the hard limit of this process.
  static void raise_open_files();

  // Binds the address: the port (0: any free one) of an IPv4 address, an [IPv6] address or a name;
  // or a Unix socket of mode 0600, which replaces a file at its path. ALREADY_EXISTS: another
  // process uses the address. INVALID_ARGUMENT: the host does not belong to this machine.
  static absl::StatusOr<std::unique_ptr<FrontGate>> open(const Address& address,
                                                         Visitors& visitors);
  virtual ~FrontGate() = default;

  [[nodiscard]] virtual int port() const = 0;
  // Starts to accept connections for a server that has started. Connections that send nothing for
  // patience_ms [ms] are closed.
  virtual void start(std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> server,
                     int patience_ms) = 0;
  // Refuses further connections; existing ones continue.
  virtual void close_door() = 0;
  // Sends the server's last bytes and ends. Call it after the server has shut down.
  virtual void stop() = 0;
};

}  // namespace irsig
