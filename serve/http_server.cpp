#include "serve/http_server.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <csignal>
#include <optional>

#include "core/base/status_macros.h"

namespace irsig {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using Tcp = asio::ip::tcp;
using boost::system::error_code;
using std::chrono::seconds;

constexpr std::size_t kThreads = 8;
constexpr std::size_t kMostConnections = 256, kMostOfOnePeer = 64;
constexpr std::uint32_t kMostHeadBytes = 64 * 1024;
constexpr seconds kHeadTime{10}, kReplyTime{30}, kClosingTime{1}, kPauseWithoutFiles{1};
constexpr std::size_t kSlowestBytesPerSecond = 10'000;

class Connections;

// One connection: reads a head, has it answered, sends the answer, waits until the peer closes.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  enum class Stage { kReading, kAnswering, kSending, kClosing };

  Connection(Connections& all, Tcp::socket socket, asio::ip::address peer)
      : all_(all), stream_(std::move(socket)), peer_(std::move(peer)), buffer_(kMostHeadBytes) {
    timer_.emplace(stream_.get_executor());
  }

  void read();
  void send(HttpReply reply);
  // Closes the connection: handlers that are called later do nothing.
  void end() {
    ended_ = true;
    stream_.close();
  }
  [[nodiscard]] Stage stage() const { return stage_; }
  // Returns true if the connection has had a reply after which it stays open.
  [[nodiscard]] bool kept() const { return kept_; }
  [[nodiscard]] const asio::ip::address& peer() const { return peer_; }

 private:
  void have_answered();
  void write();
  void wait_for_close();
  void leave();

  Connections& all_;
  beast::tcp_stream stream_;
  asio::ip::address peer_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  std::optional<asio::steady_timer> timer_;
  bool kept_ = false;
  bool is_head_ = false;  // the request's method
  std::optional<http::response<http::string_body>> reply_;
  std::optional<http::response_serializer<http::string_body>> serializer_;
  std::array<char, 4096> ignored_;
  Stage stage_ = Stage::kReading;
  bool ended_ = false;
};

// All connections, oldest first. Used by the thread of the I/O context alone.
class Connections {
 public:
  Connections(asio::io_context& io, const HttpServer::Answers& answers)
      : io_(io), answers_(answers) {}

  void admit(Tcp::socket socket) {
    error_code error;
    const Tcp::endpoint peer = socket.remote_endpoint(error);
    if (error || !make_room(peer.address())) return;
    all_.push_back(std::make_shared<Connection>(*this, std::move(socket), peer.address()));
    all_.back()->read();
  }
  void remove(const Connection* gone) {
    std::erase_if(all_, [&](const auto& one) { return one.get() == gone; });
  }
  // Closes one connection to free its file, if one can be closed.
  bool end_one() {
    return end_oldest([](const Connection&) { return true; });
  }

  void answer(const std::shared_ptr<Connection>& connection, HttpRequest request) {
    asio::post(pool_, [this, connection, request = std::move(request)] {
      HttpReply reply = answer_or_refuse(request);
      asio::post(io_, [connection, reply = std::move(reply)]() mutable {
        connection->send(std::move(reply));
      });
    });
  }
  [[nodiscard]] HttpReply refused(int status) const { return answers_.refused(status); }

  void stop() {
    pool_.stop();
    pool_.join();
  }

 private:
  bool make_room(const asio::ip::address& peer) {
    const auto is_from_peer = [&](const Connection& one) { return one.peer() == peer; };
    const auto from_peer = std::count_if(all_.begin(), all_.end(),
                                         [&](const auto& one) { return is_from_peer(*one); });
    if (!peer.is_loopback() && static_cast<std::size_t>(from_peer) >= kMostOfOnePeer)
      return end_oldest(is_from_peer);
    return all_.size() < kMostConnections || end_one();
  }

  template <typename Condition>
  bool end_oldest(const Condition& condition) {
    using Stage = Connection::Stage;
    for (const bool last_resort : {false, true}) {
      const auto oldest = std::find_if(all_.begin(), all_.end(), [&](const auto& one) {
        const Stage stage = one->stage();
        return condition(*one) && stage != Stage::kAnswering &&
               (last_resort || (stage != Stage::kSending && !one->kept()));
      });
      if (oldest == all_.end()) continue;
      (*oldest)->end();
      all_.erase(oldest);
      return true;
    }
    return false;
  }

  [[nodiscard]] HttpReply answer_or_refuse(const HttpRequest& request) const {
    try {
      return answers_.answer(request);
    } catch (...) {
      // The libraries below throw nothing on purpose: out of memory, mostly.
      return answers_.refused(500);
    }
  }

  asio::io_context& io_;
  const HttpServer::Answers& answers_;
  std::vector<std::shared_ptr<Connection>> all_;
  asio::thread_pool pool_{kThreads};
};

void Connection::read() {
  stage_ = Stage::kReading;
  parser_.emplace();
  parser_->header_limit(kMostHeadBytes);
  stream_.expires_after(kHeadTime);  // of the whole head, however it is cut
  http::async_read_header(
      stream_, buffer_, *parser_, [self = shared_from_this()](error_code error, std::size_t) {
        if (self->ended_) return;
        if (!error) return self->have_answered();
        if (error == http::error::header_limit || error == http::error::buffer_overflow)
          return self->send(self->all_.refused(431));
        if (error == http::error::body_limit) return self->send(self->all_.refused(413));
        // Beast's own errors of a head that is there; the others are of the network and of time.
        if (error.category() == make_error_code(http::error::bad_method).category() &&
            error != http::error::end_of_stream)
          return self->send(self->all_.refused(400));
        self->leave();
      });
}

void Connection::have_answered() {
  stage_ = Stage::kAnswering;
  const auto& head = parser_->get();
  HttpRequest request{std::string(head.method_string()), std::string(head.target()), {}};
  const auto hosts = head.equal_range(http::field::host);
  for (auto host = hosts.first; host != hosts.second; ++host)
    request.host.emplace_back(host->value());
  is_head_ = head.method() == http::verb::head;
  all_.answer(shared_from_this(), std::move(request));
}

void Connection::send(HttpReply reply) {
  if (ended_) return;
  stage_ = Stage::kSending;
  reply_.emplace(static_cast<http::status>(reply.status), 11);
  for (const auto& [name, value] : reply.headers) reply_->set(name, value);
  const bool stays = reply.keep_alive && parser_->is_done() && parser_->get().keep_alive();
  reply_->keep_alive(stays);
  reply_->content_length(reply.body.size());
  reply_->body() = std::move(reply.body);
  if (reply.pause_ms == 0) return write();
  stream_.expires_never();
  timer_->expires_after(std::chrono::milliseconds(reply.pause_ms));
  timer_->async_wait([self = shared_from_this()](error_code) {
    if (!self->ended_) self->write();
  });
}

void Connection::write() {
  stream_.expires_after(kReplyTime + seconds(reply_->body().size() / kSlowestBytesPerSecond));
  serializer_.emplace(*reply_);
  auto sent = [self = shared_from_this()](error_code error, std::size_t) {
    if (self->ended_) return;
    if (error) return self->leave();
    if (!self->reply_->keep_alive()) return self->wait_for_close();
    self->kept_ = true;
    self->read();
  };
  is_head_ ? http::async_write_header(stream_, *serializer_, std::move(sent))
           : http::async_write(stream_, *serializer_, std::move(sent));
}

// A socket that is closed with bytes unread resets the connection, and the peer loses the reply.
void Connection::wait_for_close() {
  if (stage_ != Stage::kClosing) {
    stage_ = Stage::kClosing;
    error_code ignored;
    stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
    serializer_.reset();
    reply_.reset();
    stream_.expires_after(kClosingTime);
  }
  stream_.async_read_some(asio::buffer(ignored_),
                          [self = shared_from_this()](error_code error, std::size_t) {
                            if (self->ended_) return;
                            error ? self->leave() : self->wait_for_close();
                          });
}

void Connection::leave() {
  end();
  all_.remove(this);
}

class Server : public HttpServer {
 public:
  Server() : acceptor_(io_), pause_(io_), signals_(io_, SIGINT, SIGTERM) {}

  absl::Status listen_at(const std::string& address, int port) {
    error_code error;
    const Tcp::endpoint place(asio::ip::make_address(address, error),
                              static_cast<std::uint16_t>(port));
    // Without SO_REUSEPORT, by which a second server could take the same port.
    if (!error) acceptor_.open(place.protocol(), error);
    if (!error) acceptor_.set_option(Tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor_.bind(place, error);
    if (!error) acceptor_.listen(Tcp::acceptor::max_listen_connections, error);
    if (!error) port_ = acceptor_.local_endpoint(error).port();
    if (!error) return absl::OkStatus();
    return absl::UnavailableError(
        fmt::format("cannot listen at {}, port {}: {} (--port 0 takes one that is free)", address,
                    port, error.message()));
  }

  [[nodiscard]] int port() const override { return port_; }

  void run(const Answers& answers) override {
    Connections connections(io_, answers);
    signals_.async_wait([this](error_code, int) { io_.stop(); });
    accept(connections);
    io_.run();
    connections.stop();
  }

 private:
  void accept(Connections& connections) {
    acceptor_.async_accept([this, &connections](error_code error, Tcp::socket socket) {
      if (!error) connections.admit(std::move(socket));
      // Without a free file: one is freed, or awaited.
      if (!error || error == asio::error::connection_aborted || connections.end_one())
        return accept(connections);
      pause_.expires_after(kPauseWithoutFiles);
      pause_.async_wait([this, &connections](error_code) { accept(connections); });
    });
  }

  asio::io_context io_{1};
  Tcp::acceptor acceptor_;
  asio::steady_timer pause_;
  asio::signal_set signals_;
  int port_ = 0;
};

}  // namespace

absl::StatusOr<std::unique_ptr<HttpServer>> HttpServer::listen(const std::string& address,
                                                               int port) {
  auto server = std::make_unique<Server>();
  RETURN_IF_ERROR(server->listen_at(address, port));
  return server;
}

}  // namespace irsig
