#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace irsig {

// Where a coordinator listens. Until there is mutual TLS, only what cannot be reached from another
// machine: a Unix socket or a loopback port.
struct Address {
  std::string text;       // as given
  std::string target;     // as gRPC wants it
  std::string unix_path;  // empty for a loopback port
};

// "unix:PATH", "127.x.y.z:PORT", "[::1]:PORT" or "localhost:PORT" (which stands for 127.0.0.1).
// INVALID_ARGUMENT for everything else, other hosts included.
[[nodiscard]] absl::StatusOr<Address> parse_address(std::string_view text);

}  // namespace irsig
