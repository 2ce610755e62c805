#include "serve/hosts.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "absl/strings/match.h"
#include "core/base/printable.h"

namespace irsig {
namespace {

struct Ip {
  bool v6, loopback;
};

std::optional<Ip> ip_of(const std::string& text) {
  in_addr v4{};
  if (inet_pton(AF_INET, text.c_str(), &v4) == 1) return Ip{false, (ntohl(v4.s_addr) >> 24) == 127};
  in6_addr v6{};
  if (inet_pton(AF_INET6, text.c_str(), &v6) == 1) return Ip{true, IN6_IS_ADDR_LOOPBACK(&v6) != 0};
  return std::nullopt;
}

bool is_port(std::string_view text) {
  return !text.empty() && text.size() <= 5 &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

absl::StatusOr<ListenAddress> parse_listen_address(const std::string& text) {
  if (text == "localhost") return ListenAddress{"127.0.0.1", true};
  const std::optional<Ip> ip = ip_of(text);
  if (!ip)
    return absl::InvalidArgumentError(
        fmt::format("--address {}: expected an IP address as 127.0.0.1, ::1 or 0.0.0.0 (all), or "
                    "localhost",
                    printable(text)));
  return ListenAddress{text, ip->loopback};
}

std::string page_url(const ListenAddress& address, int port, std::string_view secret) {
  const bool v6 = address.address.find(':') != std::string::npos;
  return fmt::format("http://{}{}{}:{}/{}/", v6 ? "[" : "", address.address, v6 ? "]" : "", port,
                     secret);
}

bool is_our_host(std::string_view host, bool loopback_only) {
  std::string_view name = host;
  const bool bracket = name.starts_with('[');
  if (bracket) {
    const std::size_t end = name.find(']');
    if (end == std::string_view::npos) return false;
    const std::string_view rest = name.substr(end + 1);
    if (!rest.empty() && !(rest.starts_with(':') && is_port(rest.substr(1)))) return false;
    name = name.substr(1, end - 1);
  } else if (const std::size_t colon = name.find(':'); colon != std::string_view::npos) {
    if (!is_port(name.substr(colon + 1))) return false;
    name = name.substr(0, colon);
  }
  if (!bracket && absl::EqualsIgnoreCase(std::string(name), "localhost")) return true;
  const std::optional<Ip> ip = ip_of(std::string(name));
  return ip && ip->v6 == bracket && (ip->loopback || !loopback_only);
}

}  // namespace irsig
