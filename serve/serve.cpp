#include "serve/serve.h"

#include <fmt/format.h>
#include <httplib.h>
#include <pthread.h>
#include <sys/socket.h>

#include <atomic>
#include <csignal>
#include <memory>
#include <thread>
#include <utility>

#include "schema/store/store.h"
#include "serve/answers.h"
#include "serve/hosts.h"

namespace irsig {
namespace {

// A connection takes a thread, and is closed after one answer, so that idle ones hold none.
constexpr std::size_t kThreads = 12;
constexpr std::size_t kAnswersPerConnection = 1;
constexpr time_t kFirstByteTimeout_s = 1, kReadTimeout_s = 5, kWriteTimeout_s = 30;

// Nothing but what this server sends is loaded, run or shown, and nobody shows it inside their own
// page.
const httplib::Headers kHeaders = {
    {"Content-Security-Policy",
     "default-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Cache-Control", "no-store"},
};

constexpr const char* kSelfContained =
    "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'";

void send(const PageReply& reply, httplib::Response& response) {
  response.status = reply.status;
  if (reply.is_self_contained) {
    response.headers.erase("Content-Security-Policy");
    response.set_header("Content-Security-Policy", kSelfContained);
  }
  if (!reply.file_name.empty())
    response.set_header("Content-Disposition",
                        fmt::format("attachment; filename=\"{}\"", reply.file_name));
  // By a provider of known length: bodies that are set are compressed, slower than they are sent.
  const auto body = std::make_shared<const std::string>(reply.body);
  response.set_content_provider(
      body->size(), reply.type,
      [body](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
        return sink.write(body->data() + offset, length);
      });
}

class Page {
 public:
  Page(const ServeOptions& options, bool loopback_only)
      : sources_{options.database, options.detector, options.extent_of, options.farm,
                 options.accuracy_page},
        loopback_only_(loopback_only) {}

  [[nodiscard]] PageReply reply_to(const httplib::Request& request) const {
    if (request.get_header_value_count("Host") != 1 ||
        !is_our_host(request.get_header_value("Host"), loopback_only_))
      return error_reply(403, "this page answers to localhost and to IP addresses only");
    if (request.method != "GET" && request.method != "HEAD")
      return error_reply(405, "this page is only read: GET and HEAD");
    return answer(sources_, request.path, request.params);
  }

 private:
  PageSources sources_;
  bool loopback_only_;
};

void set_up(httplib::Server& server, const Page& page) {
  server.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  server.set_keep_alive_max_count(kAnswersPerConnection);
  server.set_keep_alive_timeout(kFirstByteTimeout_s);
  server.set_read_timeout(kReadTimeout_s);
  server.set_write_timeout(kWriteTimeout_s);
  server.set_payload_max_length(1);
  server.set_default_headers(kHeaders);
  // Without SO_REUSEPORT, by which a second server could take the same port.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  // Before routing, so that a path is compared and never matched with a pattern.
  server.set_pre_routing_handler(
      [&page](const httplib::Request& request, httplib::Response& response) {
        PageReply reply = page.reply_to(request);
        if (reply.status == 405) response.set_header("Allow", "GET, HEAD");
        send(reply, response);
        return httplib::Server::HandlerResponse::Handled;
      });
  // What httplib refuses by itself: a request that is none, or too long.
  const httplib::Server::HandlerWithResponse refused = [](const httplib::Request&,
                                                          httplib::Response& response) {
    if (response.content_length_ > 0 || !response.body.empty())
      return httplib::Server::HandlerResponse::Unhandled;
    const PageReply reply =
        error_reply(response.status, fmt::format("the request was refused ({})", response.status));
    response.set_content(reply.body, "application/json; charset=utf-8");
    return httplib::Server::HandlerResponse::Handled;
  };
  server.set_error_handler(refused);
  server.set_exception_handler(
      [](const httplib::Request&, httplib::Response& response, std::exception_ptr) {
        // The libraries below throw nothing on purpose: out of memory, mostly.
        send(error_reply(500, "the answer could not be made (out of memory?)"), response);
      });
}

// Ends a server at the first SIGINT or SIGTERM, which no other thread gets.
class StopOnSignal {
 public:
  explicit StopOnSignal(httplib::Server& server) {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals, &before_);
    thread_ = std::thread([this, &server, signals] {
      int signal = 0;
      sigwait(&signals, &signal);
      while (!done_ && !server.is_running()) std::this_thread::sleep_for(kPoll);
      if (!done_) server.stop();
    });
  }
  ~StopOnSignal() {
    done_ = true;
    pthread_kill(thread_.native_handle(), SIGTERM);
    thread_.join();
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

 private:
  static constexpr std::chrono::milliseconds kPoll{2};
  sigset_t before_{};
  std::atomic<bool> done_ = false;
  std::thread thread_;
};

}  // namespace

absl::Status serve(const ServeOptions& options) {
  const auto address = parse_listen_address(options.address);
  if (!address.ok()) return address.status();
  if (options.port < 0 || options.port > 65535)
    return absl::InvalidArgumentError(
        fmt::format("--port {}: expected 0 (a free one) to 65535", options.port));
  for (const std::string& database : options.database)
    if (const auto reader = StoreReader::open(database); !reader.ok()) return reader.status();

  httplib::Server server;
  const Page page(options, address->loopback);
  set_up(server, page);
  const StopOnSignal stop(server);
  const int port = options.port == 0 ? server.bind_to_any_port(address->address)
                   : server.bind_to_port(address->address, options.port) ? options.port
                                                                         : -1;
  if (port <= 0)
    return absl::UnavailableError(
        fmt::format("cannot listen at {}, port {}: it is taken, or not ours (--port 0 takes one "
                    "that is free)",
                    address->address, options.port));
  options.on_ready(page_url(*address, port),
                   address->loopback ? ""
                                     : fmt::format("whoever reaches {} on the network can read "
                                                   "these databases: there is no password and no "
                                                   "encryption",
                                                   address->address));
  if (!server.listen_after_bind()) return absl::UnavailableError("the page's server stopped");
  return absl::OkStatus();
}

}  // namespace irsig
