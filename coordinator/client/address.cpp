#include "coordinator/client/address.h"

#include <arpa/inet.h>
#include <sys/un.h>

#include <charconv>
#include <filesystem>

#include "absl/strings/str_cat.h"
#include "fmt/format.h"

namespace irsig {
namespace {

absl::Status refuse(std::string_view text, std::string_view why) {
  return absl::InvalidArgumentError(fmt::format(
      "address \"{}\": {}; expected unix:PATH or a loopback port such as 127.0.0.1:50051", text,
      why));
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
  return Address{std::string(text), "unix:" + absolute, absolute};
}

}  // namespace

absl::StatusOr<Address> parse_address(std::string_view text) {
  if (text.starts_with("unix:")) return parse_unix(text);
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
  if (host == "localhost") {
    return Address{std::string(text), absl::StrCat("ipv4:127.0.0.1:", port), ""};
  }
  if (host == "[::1]") return Address{std::string(text), absl::StrCat("ipv6:[::1]:", port), ""};
  in_addr ip4{};
  if (inet_pton(AF_INET, host.c_str(), &ip4) == 1 && (ntohl(ip4.s_addr) >> 24) == 127) {
    return Address{std::string(text), absl::StrCat("ipv4:", host, ":", port), ""};
  }
  return refuse(text,
                "not a loopback address: connections are not encrypted yet, so that only this "
                "machine may be reached");
}

}  // namespace irsig
