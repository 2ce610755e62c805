#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// The head of a request. Bodies are never read.
struct HttpRequest {
  std::string method;             // as sent: "GET"
  std::string target;             // as sent, not decoded: "/map?season=winter"
  std::vector<std::string> host;  // every Host header
};

struct HttpReply {
  int status = 200;
  std::vector<std::pair<std::string, std::string>> headers;
  std::string body;  // sent whole: Range headers are ignored
  // True if the connection waits for another request, provided that the client wants that too.
  bool keep_alive = false;
  std::uint32_t pause_ms = 0;  // before it is sent: the rate of a client that is refused
};

// A server of HTTP/1.1 with one request a connection, or as many as replies allow. Its memory and
// threads do not depend on its clients.
//   - A request head has 10 s and 64 kB; longer or slower ones are refused before they are parsed.
//   - 256 connections are kept, 64 of each peer that is not on this machine. A further connection
//     ends the oldest one that has not sent its first head, or whose answer is sent and that has
//     not closed; then the oldest that reads its answer. If all wait for answers, the new
//     connection is closed.
//   - A client must receive a reply within 30 s and 1 s for each 10 kB.
class HttpServer {
 public:
  // Listens at an IP address; port 0 selects a free one. From then on SIGINT and SIGTERM end run().
  // UNAVAILABLE: the port is in use, or the address does not belong to this machine.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<HttpServer>> listen(
      const std::string& address, int port);
  virtual ~HttpServer() = default;

  [[nodiscard]] virtual int port() const = 0;

  // Answers requests until SIGINT or SIGTERM. `answer` is called by several threads at
  // once; `refused` makes the
  // reply to a request that is not valid HTTP (400), too large (413, 431), or for which `answer`
  // throws (500).
  struct Answers {
    std::function<HttpReply(const HttpRequest&)> answer;
    std::function<HttpReply(int status)> refused;
  };
  virtual void run(const Answers& answers) = 0;
};

}  // namespace irsig
