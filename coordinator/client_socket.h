#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "coordinator/client/tls.h"

namespace irsig {

// The connected socket of a client, with or without TLS, for one thread that waits by itself: no
// call of it blocks. The descriptor stays the caller's.
class ClientSocket {
 public:
  // Outcome of a call: bytes were moved (0: the handshake is done), the call is to be made again
  // when the descriptor can be read or written, or the connection has ended.
  enum class Next { kGoOn, kAfterReading, kAfterWriting, kEnded };
  struct Step {
    Next next;
    std::size_t bytes = 0;
  };

  virtual ~ClientSocket() = default;
  virtual Step shake_hands() = 0;
  virtual Step read(char* into, std::size_t room) = 0;
  virtual Step write(const char* from, std::size_t size) = 0;
  // Returns the reason for which the handshake ended. Empty: the client closed the connection.
  [[nodiscard]] virtual std::string problem() const = 0;
  // Returns the client's certificate in PEM; empty without TLS.
  [[nodiscard]] virtual std::string certificate() const = 0;
};

// Makes the sockets of clients, in one way for all connections of a port.
class ClientSockets {
 public:
  virtual ~ClientSockets() = default;
  [[nodiscard]] virtual std::unique_ptr<ClientSocket> make(int fd) = 0;
};

[[nodiscard]] std::unique_ptr<ClientSockets> plain_sockets();
// Creates sockets with mutual TLS 1.2 or 1.3 for HTTP/2; clients without a certificate of the
// authority are refused. INVALID_ARGUMENT: OpenSSL refuses the identity, although read_tls()
// accepted it.
[[nodiscard]] absl::StatusOr<std::unique_ptr<ClientSockets>> tls_sockets(const TlsIdentity& tls);

}  // namespace irsig
