#include "serve/serve.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "core/base/status_macros.h"
#include "schema/store/reader.h"
#include "serve/answers.h"
#include "serve/hosts.h"
#include "serve/http_server.h"
#include "serve/target.h"

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
  HttpReply out{reply.status, {}, std::move(reply.body)};
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

class Page {
 public:
  Page(const ServeOptions& options, std::string_view secret, bool loopback_only)
      : sources_{options.database, options.detector, options.extent_of, options.farm,
                 options.accuracy_page},
        root_(fmt::format("/{}/", secret)),
        loopback_only_(loopback_only) {}

  // The secret comes first: nothing else of a request is looked at before it is right.
  [[nodiscard]] PageReply reply_to(const HttpRequest& request) const {
    const std::string_view target = request.target;
    if (!equal_in_constant_time(target.substr(0, root_.size()), root_))
      return error_reply(403, "open the address that irsig serve printed");
    if (request.host.size() != 1 || !is_our_host(request.host[0], loopback_only_))
      return error_reply(403, "this page answers to localhost and to IP addresses only");
    if (request.method != "GET" && request.method != "HEAD")
      return error_reply(405, "this page is only read: GET and HEAD");
    if (target.size() > kLongestTarget)
      return error_reply(414, fmt::format("the address is longer than {} bytes", kLongestTarget));
    const auto below = parse_target(target.substr(root_.size() - 1));
    if (!below.ok()) return error_reply(400, std::string(below.status().message()));
    return answer(sources_, below->path, below->parameters);
  }

 private:
  PageSources sources_;
  std::string root_;
  bool loopback_only_;
};

}  // namespace

absl::Status serve(const ServeOptions& options) {
  ASSIGN_OR_RETURN(const auto address, parse_listen_address(options.address));
  if (options.port < 0 || options.port > 65535)
    return absl::InvalidArgumentError(
        fmt::format("--port {}: expected 0 (a free one) to 65535", options.port));
  for (const std::string& database : options.database)
    if (const auto reader = StoreReader::open(database); !reader.ok()) return reader.status();
  ASSIGN_OR_RETURN(const auto secret, new_secret());
  ASSIGN_OR_RETURN(const auto server, HttpServer::listen(address.address, options.port));

  const Page page(options, secret, address.loopback);
  options.on_ready(
      page_url(address, server->port(), secret),
      address.loopback
          ? ""
          : fmt::format("whoever knows the address below and reaches {} can read these databases; "
                        "nothing is encrypted, so that whoever can listen to the network learns it",
                        address.address));
  server->run(
      {[&](const HttpRequest& request) { return http_reply(page.reply_to(request)); }, refused});
  return absl::OkStatus();
}

}  // namespace irsig
