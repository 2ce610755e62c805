#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace irsig {

// An address at which a page may be served.
struct ListenAddress {
  std::string address;  // as sockets want it: 127.0.0.1, ::1
  bool loopback;
};

// Parses an address. INVALID_ARGUMENT: the host is neither an IP address nor localhost.
[[nodiscard]] absl::StatusOr<ListenAddress> parse_listen_address(const std::string& text);

// Returns "http://127.0.0.1:8017/SECRET/": every route of the page lies below it.
[[nodiscard]] std::string page_url(const ListenAddress& address, int port, std::string_view secret);

// Returns true if a request with this Host header was meant for this server: localhost or an IP
// address, with any port (it may have been forwarded), and a loopback address if the server listens
// on no other. A network name is refused; otherwise a foreign page whose name was made to point
// here (DNS rebinding) could read the databases.
[[nodiscard]] bool is_our_host(std::string_view host, bool loopback_only);

}  // namespace irsig
