#include "coordinator/client/address.h"

#include <arpa/inet.h>
#include <sys/un.h>

#include <charconv>
#include <filesystem>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "fmt/format.h"

namespace irsig {
namespace {

absl::Status refuse(std::string_view text, std::string_view why) {
  return absl::InvalidArgumentError(
      fmt::format("address \"{}\": {}; expected unix:PATH, or HOST:PORT with TLS", text, why));
}

absl::StatusOr<Address> parse_unix(std::string_view text) {
  std::string_view path = text.substr(5);
  if (path.starts_with("///")) path.remove_prefix(2);  // unix:///absolute
  if (path.empty()) return refuse(text, "no path after unix:");
  std::error_code error;
  const std::string absolute = std::filesystem::absolute(path, error).string();
  if (error) return refuse(text, error.message());
  if (absolute.size() >= sizeof(sockaddr_un::sun_path)) {
    return refuse(
        text, absl::StrCat("the path of a Unix socket may have ", sizeof(sockaddr_un::sun_path) - 1,
                           " bytes, this one has ", absolute.size()));
  }
  return Address{std::string(text), "unix:" + absolute, absolute, "", nullptr};
}

bool is_host_name(std::string_view host) {
  return !host.empty() &&
         host.find_first_not_of(
             "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
             "0123456789.-") == std::string_view::npos &&
         host.find_first_not_of("0123456789.") != std::string_view::npos;
}

struct Place {
  Address address;
  bool loopback = false;
};

absl::StatusOr<Place> parse_port(std::string_view text) {
  const auto colon = text.rfind(':');
  if (colon == std::string_view::npos) return refuse(text, "no port");
  const std::string host(text.substr(0, colon));
  const std::string_view port_text = text.substr(colon + 1);
  unsigned port = 0;
  const auto [end, problem] =
      std::from_chars(port_text.data(), port_text.data() + port_text.size(), port);
  if (problem != std::errc() || end != port_text.data() + port_text.size() || port > 65535) {
    return refuse(text, "the port is not a number between 0 and 65535");
  }
  const auto at = [&](const std::string& target, const std::string& bare_host, bool loopback) {
    return Place{{std::string(text), absl::StrCat(target, ":", port), "", bare_host, nullptr},
                 loopback};
  };
  in_addr ip4{};
  if (inet_pton(AF_INET, host.c_str(), &ip4) == 1)
    return at("ipv4:" + host, host, (ntohl(ip4.s_addr) >> 24) == 127);
  if (host == "localhost") return at("ipv4:127.0.0.1", host, true);
  if (host.starts_with('[') && host.ends_with(']')) {
    const std::string bare = host.substr(1, host.size() - 2);
    in6_addr ip6{};
    if (inet_pton(AF_INET6, bare.c_str(), &ip6) == 1)
      return at("ipv6:" + host, bare, IN6_IS_ADDR_LOOPBACK(&ip6));
  }
  if (is_host_name(host)) return at("dns:" + host, host, false);
  return refuse(text, "no host");
}

}  // namespace

absl::StatusOr<Address> parse_address(std::string_view text, const NetworkOptions& network) {
  if (text.starts_with("unix:")) {
    if (network.tls.any())
      return refuse(text, "TLS is for ports: a Unix socket is protected by its mode");
    return parse_unix(text);
  }
  ASSIGN_OR_RETURN(auto place, parse_port(text));
  if (network.tls.any() && (network.insecure_network || network.insecure_loopback))
    return refuse(text, network.insecure_network
                            ? "--insecure-network is for addresses without TLS"
                            : "--insecure-loopback is for addresses without TLS");
  if (network.tls.any()) {
    ASSIGN_OR_RETURN(auto identity, read_tls(network.tls));
    place.address.tls = std::make_shared<const TlsIdentity>(std::move(identity));
  } else if (place.loopback && !network.insecure_loopback && !network.insecure_network) {
    return refuse(
        text,
        "whoever uses this machine could do everything there; use a Unix socket, give --tls-cert, "
        "--tls-key and --tls-ca, or --insecure-loopback where all users of the machine are "
        "trusted");
  } else if (!place.loopback && !network.insecure_network) {
    return refuse(
        text,
        "not a loopback address: whoever reaches it from another machine could do "
        "everything; give --tls-cert, --tls-key and --tls-ca, or --insecure-network where "
        "all who are on the network are trusted");
  }
  return std::move(place.address);
}

}  // namespace irsig
