#include "serve/guarded_page.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "core/base/status_macros.h"
#include "serve/http_server.h"

namespace irsig {
namespace {

constexpr std::size_t kLongestTarget = 8192;
constexpr std::size_t kSecretBytes = 16;

// A browser loads, runs and shows nothing but what this server sends, and no other page frames it.
constexpr std::pair<const char*, const char*> kHeaders[] = {
    {"X-Content-Type-Options", "nosniff"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Cache-Control", "no-store"},
    {"Accept-Ranges", "none"},
};
constexpr const char* kPolicy =
    "default-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
constexpr const char* kSelfContainedPolicy =
    "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'";

HttpReply http_reply(PageReply reply) {
  HttpReply out{reply.status, {}, std::move(reply.body), reply.keep_alive, reply.pause_ms};
  for (const auto& [name, value] : kHeaders) out.headers.emplace_back(name, value);
  out.headers.emplace_back("Content-Security-Policy",
                           reply.is_self_contained ? kSelfContainedPolicy : kPolicy);
  out.headers.emplace_back("Content-Type", std::move(reply.type));
  if (!reply.file_name.empty())
    out.headers.emplace_back("Content-Disposition",
                             fmt::format("attachment; filename=\"{}\"", reply.file_name));
  if (reply.status == 405) out.headers.emplace_back("Allow", "GET, HEAD");
  return out;
}

HttpReply refused(int status) {
  return http_reply(error_reply(status, status == 500
                                            ? "the answer could not be made (out of memory?)"
                                            : fmt::format("the request was refused ({})", status)));
}

// 128 random bits as hexadecimal digits.
absl::StatusOr<std::string> new_secret() {
  std::array<unsigned char, kSecretBytes> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    return absl::UnavailableError("this system gives no random bytes (getrandom)");
  return fmt::format("{:02x}", fmt::join(bytes, ""));
}

// The secret comes first: nothing else of a request is looked at before it is right.
PageReply reply_to(const HttpRequest& request, const GuardedPage& page, std::string_view root,
                   bool loopback) {
  const std::string_view target = request.target;
  if (!equal_in_constant_time(target.substr(0, root.size()), root))
    return error_reply(403, fmt::format("open the address that {} printed", page.command));
  if (request.host.size() != 1 || !is_our_host(request.host[0], loopback))
    return error_reply(403, "this page answers to localhost and to IP addresses only");
  if (request.method != "GET" && request.method != "HEAD")
    return error_reply(405, "this page is only read: GET and HEAD");
  if (target.size() > kLongestTarget)
    return error_reply(414, fmt::format("the address is longer than {} bytes", kLongestTarget));
  const auto below = parse_target(target.substr(root.size() - 1));
  if (!below.ok()) return error_reply(400, std::string(below.status().message()));
  return page.answer(*below);
}

}  // namespace

absl::Status serve_guarded(const GuardedPage& page) {
  ASSIGN_OR_RETURN(const auto address, parse_listen_address(page.address));
  if (page.loopback_only && !address.loopback)
    return absl::InvalidArgumentError(
        fmt::format("--address {}: {} listens on this machine alone, expected 127.0.0.1 or ::1; "
                    "from elsewhere use `ssh -L`",
                    page.address, page.command));
  if (page.port < 0 || page.port > 65535)
    return absl::InvalidArgumentError(
        fmt::format("--port {}: expected 0 (a free one) to 65535", page.port));
  ASSIGN_OR_RETURN(const auto secret, new_secret());
  ASSIGN_OR_RETURN(const auto server, HttpServer::listen(address.address, page.port));
  const std::string root = fmt::format("/{}/", secret);
  page.on_ready(page_url(address, server->port(), secret), address);
  server->run({[&](const HttpRequest& request) {
                 return http_reply(reply_to(request, page, root, address.loopback));
               },
               refused});
  return absl::OkStatus();
}

}  // namespace irsig
