#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "coordinator/client/tls.h"

namespace irsig {

// Address at which a coordinator listens, and the identity that both sides prove there.
struct Address {
  std::string text;       // as given
  std::string target;     // as gRPC wants it
  std::string unix_path;  // empty for a port
  std::string host;       // that the coordinator's certificate must name; empty for a Unix socket
  std::shared_ptr<const TlsIdentity> tls;  // null: neither encrypted nor authenticated
};

// A user's options of the network.
struct NetworkOptions {
  TlsFiles tls;
  bool insecure_loopback = false;  // so may everybody on this machine
  bool insecure_network = false;   // and on other machines
};

// Parses an address: "unix:PATH", or HOST:PORT with TLS, where HOST is an IPv4 address, [IPv6] or a
// name. Without TLS, 127.x.y.z, [::1] and localhost (read as 127.0.0.1) need insecure_loopback or
// insecure_network; other hosts need insecure_network. INVALID_ARGUMENT: any other text, or files
// of TLS that read_tls refuses.
[[nodiscard]] absl::StatusOr<Address> parse_address(std::string_view text,
                                                    const NetworkOptions& network = {});

// Adds the options of a program that listens or connects; the parsed values go to `network`. App:
// CLI::App.
template <class App>
void add_network_options(App& app, NetworkOptions& network) {
  app.add_option("--tls-cert", network.tls.certificate, "PEM file: the certificate to show");
  app.add_option("--tls-key", network.tls.key, "PEM file: its private key, of mode 0600");
  app.add_option("--tls-ca", network.tls.ca,
                 "PEM file: the authority that has signed the certificates of both sides");
  app.add_flag("--insecure-loopback", network.insecure_loopback,
               "a port of this machine without TLS: everybody on it may do everything");
  app.add_flag(
      "--insecure-network", network.insecure_network,
      "an address of other machines without TLS: everybody who reaches it may do everything");
}

}  // namespace irsig
