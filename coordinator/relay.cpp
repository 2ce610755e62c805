#include "coordinator/relay.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "coordinator/client/certificate.h"
#include "coordinator/client/farm_log.h"

namespace irsig {
namespace {

namespace asio = boost::asio;
using Error = boost::system::error_code;
using Fd = asio::posix::stream_descriptor;
using Step = ClientSocket::Step;
using Next = ClientSocket::Next;

constexpr int kStepsInATurn = 8;  // then the other connections have theirs
// For what the server has said before it hung up.
constexpr auto kRelayLastWords = std::chrono::seconds(2);

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// A name that no other socket of this machine has or will have: calls outlive their connection, and
// must not find another one's certificate under it.
std::string new_name() {
  static const std::string ours = [] {
    std::random_device device;
    return absl::StrCat("irsig-gate-", absl::Hex(device(), absl::kZeroPad8),
                        absl::Hex(device(), absl::kZeroPad8), "-");
  }();
  static std::atomic<std::uint64_t> count = 0;
  return absl::StrCat(ours, ++count);
}

// Two connected sockets, of which the first has the name. False: there are no descriptors left.
bool make_pair(const std::string& name, int most_fd, int (&pair)[2]) {
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, pair) != 0) return false;
  sockaddr_un at{};
  at.sun_family = AF_UNIX;
  name.copy(at.sun_path + 1, sizeof(at.sun_path) - 1);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  if (pair[0] <= most_fd && pair[1] <= most_fd &&
      bind(pair[0], reinterpret_cast<const sockaddr*>(&at), size) == 0)
    return true;
  close(pair[0]);
  close(pair[1]);
  return false;
}

// Each function of it that waits is called again when the wait is over, until end().
class Relay : public std::enable_shared_from_this<Relay> {
 public:
  Relay(RelayDesk& desk, int client_fd, std::string address)
      : desk_(desk),
        client_fd_(desk.loop),
        server_fd_(desk.loop),
        patience_(desk.loop),
        last_words_(desk.loop),
        client_(desk.sockets->make(client_fd)),
        meter_(desk.totals),
        address_(std::move(address)) {
    ++desk_.under_way;
    Error error;
    client_fd_.assign(client_fd, error);
    if (error) close(client_fd);
  }
  ~Relay() {
    if (!peer_.empty()) desk_.visitors.leave(peer_);
    --desk_.under_way;
  }
  Relay(const Relay&) = delete;
  Relay& operator=(const Relay&) = delete;

  void start(int patience_ms) {
    patience_.expires_after(std::chrono::milliseconds(patience_ms));
    patience_.async_wait([self = shared_from_this()](Error error) {
      if (!error) self->put_out_the_silent();
    });
    shake_hands();
  }

 private:
  using Part = void (Relay::*)();

  void when(Fd& fd, Fd::wait_type what, Part part) {
    if (!fd.is_open()) return;
    fd.async_wait(what, [self = shared_from_this(), &fd, part](Error error) {
      if (!error && fd.is_open()) ((*self).*part)();
    });
  }
  void when_client(Next next, Part part) {
    when(client_fd_, next == Next::kAfterReading ? Fd::wait_read : Fd::wait_write, part);
  }
  // After the others' turn.
  void later(Part part) {
    asio::post(desk_.loop, [self = shared_from_this(), part] { ((*self).*part)(); });
  }

  // Nothing of it waits any more.
  void end() {
    Error ignored;
    patience_.cancel(ignored);
    last_words_.cancel(ignored);
    server_fd_.close(ignored);
    client_fd_.close(ignored);
  }
  [[nodiscard]] bool is_open() const { return client_fd_.is_open() && server_fd_.is_open(); }

  // Until the client has said something that is HTTP/2's.
  void put_out_the_silent() {
    if (heard_ || !client_fd_.is_open()) return;
    if (const auto more = desk_.silent.may_tell())
      log_line(LogLevel::warn, {},
               "closed: a connection from {}: its client did not end the handshake in time "
               "({} more before)",
               address_, *more);
    end();
  }

  void shake_hands() {
    if (!client_fd_.is_open()) return end();
    const Step step = client_->shake_hands();
    if (step.next == Next::kEnded) {
      log_refusal();
      return end();
    }
    if (step.next != Next::kGoOn) return when_client(step.next, &Relay::shake_hands);
    if (!reach_server()) return end();
    when(server_fd_, Fd::wait_error, &Relay::notice_the_end);
    carry_answers();
    carry_calls();
  }

  void log_refusal() {
    const std::string why = client_->problem();
    if (auto& line = why.empty() ? desk_.silent : desk_.refused; const auto more = line.may_tell())
      log_line(LogLevel::warn, {}, "refused: a TLS handshake from {}: {} ({} more before)",
               address_, why.empty() ? "its client left it" : why, *more);
  }

  bool reach_server() {
    const std::string name = new_name();
    int pair[2];
    if (!make_pair(name, desk_.most_fd, pair)) {
      if (const auto more = desk_.refused.may_tell())
        log_line(LogLevel::warn, {},
                 "refused: a connection from {}: there are no descriptors left ({} more before)",
                 address_, *more);
      return false;
    }
    Error error;
    server_fd_.assign(pair[0], error);
    if (error) {
      close(pair[0]);
      close(pair[1]);
      return false;
    }
    peer_ = absl::StrCat("unix-abstract:", name);
    desk_.visitors.enter(peer_, {address_, client_->certificate()});
    desk_.hand_on(pair[1]);
    return true;
  }

  // --- from the client to the server ---

  void carry_calls() {
    for (int steps = 0; steps < kStepsInATurn; ++steps) {
      if (!is_open()) return;
      if (!send_to_server(to_server_)) return when(server_fd_, Fd::wait_write, &Relay::carry_calls);
      to_server_.clear();
      const Step step = client_->read(desk_.scratch.data(), desk_.scratch.size());
      if (step.next == Next::kEnded) return end();
      if (step.next != Next::kGoOn) return when_client(step.next, &Relay::carry_calls);
      heard_ = true;
      const std::string_view bytes(desk_.scratch.data(), step.bytes);
      if (const auto status = meter_.from_client(bytes, now_s()); !status.ok())
        return end_for(status);
      send_to_server(bytes);
    }
    later(&Relay::carry_calls);
  }

  // True: all of them are sent, or nothing more can be. What is not sent is kept.
  bool send_to_server(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t sent =
          send(server_fd_.native_handle(), bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
      if (sent < 0 && errno == EINTR) continue;
      if (sent < 0) {
        if (errno == EAGAIN) break;
        end();
        return true;
      }
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    to_server_ = std::string(bytes);
    return to_server_.empty();
  }

  void end_for(const absl::Status& too_much) {
    if (const auto more = desk_.too_much.may_tell()) {
      std::string who = address_;
      if (const std::string pem = client_->certificate(); !pem.empty())
        if (const auto facts = certificate_facts(pem); facts.ok())
          absl::StrAppend(&who, ", \"", facts->name, "\" (certificate ", facts->serial_hex, ")");
      log_line(LogLevel::warn, {}, "closed: a connection from {}: {} ({} more before)", who,
               std::string(too_much.message()), *more);
    }
    end();
  }

  // --- from the server to the client ---

  void carry_answers() {
    for (int steps = 0; steps < kStepsInATurn; ++steps) {
      if (!is_open()) return;
      if (const Next next = send_to_client(to_client_); next != Next::kGoOn)
        return next == Next::kEnded ? end() : when_client(next, &Relay::carry_answers);
      const ssize_t got = recv(server_fd_.native_handle(), desk_.scratch.data(),
                               desk_.scratch.size(), MSG_DONTWAIT);
      if (got < 0 && errno == EINTR) continue;
      if (got < 0 && errno == EAGAIN) return when(server_fd_, Fd::wait_read, &Relay::carry_answers);
      if (got <= 0) return end();
      const std::string_view bytes(desk_.scratch.data(), static_cast<std::size_t>(got));
      if (const auto status = meter_.from_server(bytes, now_s()); !status.ok())
        return end_for(status);
      if (const Next next = send_to_client(bytes); next != Next::kGoOn)
        return next == Next::kEnded ? end() : when_client(next, &Relay::carry_answers);
    }
    later(&Relay::carry_answers);
  }

  // kGoOn: all of them are sent. What is not sent is kept.
  Next send_to_client(std::string_view bytes) {
    Step step{Next::kGoOn};
    while (!bytes.empty() && step.next == Next::kGoOn) {
      step = client_->write(bytes.data(), bytes.size());
      bytes.remove_prefix(step.bytes);
    }
    to_client_ = std::string(bytes);
    return step.next;
  }

  // The server has hung up: what it has said before still reaches a client that takes it.
  void notice_the_end() {
    last_words_.expires_after(kRelayLastWords);
    last_words_.async_wait([self = shared_from_this()](Error error) {
      if (!error) self->end();
    });
  }

  RelayDesk& desk_;
  Fd client_fd_, server_fd_;
  asio::steady_timer patience_, last_words_;
  std::unique_ptr<ClientSocket> client_;
  FrameMeter meter_;
  const std::string address_;
  std::string peer_, to_server_, to_client_;
  bool heard_ = false;
};

}  // namespace

void start_relay(RelayDesk& desk, int client_fd, std::string address, int patience_ms) {
  std::make_shared<Relay>(desk, client_fd, std::move(address))->start(patience_ms);
}

}  // namespace irsig
