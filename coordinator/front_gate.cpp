#include "coordinator/front_gate.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <list>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "coordinator/client/farm_log.h"
#include "coordinator/relay.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

// Limit of open files. A connection takes 40 kB during its handshake
// (tests/system/half_open_test.py).
constexpr rlim_t kMostOpenFiles = 16384;
// Files kept free for the database, its journals, submitted files and lists of certificates.
constexpr int kKeptFree = 64;
constexpr int kBacklog = 1024;
constexpr auto kPause = std::chrono::milliseconds(100);
constexpr auto kLastWords = std::chrono::seconds(2);  // of the server, when the gate stops
constexpr int kConnectionsInATurn = 64;

namespace asio = boost::asio;
using Error = boost::system::error_code;
using Fd = asio::posix::stream_descriptor;

using Found = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

absl::StatusOr<Found> resolve(const std::string& host, const std::string& port) {
  addrinfo wish{};
  wish.ai_family = AF_UNSPEC;
  wish.ai_socktype = SOCK_STREAM;
  wish.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(host.c_str(), port.c_str(), &wish, &found); error != 0)
    return absl::InvalidArgumentError(absl::StrCat(host, ": ", gai_strerror(error)));
  return Found(found, freeaddrinfo);
}

int port_of(int fd) {
  sockaddr_storage bound{};
  socklen_t length = sizeof(bound);
  if (getsockname(fd, reinterpret_cast<sockaddr*>(&bound), &length) != 0) return 0;
  return ntohs(bound.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6*>(&bound)->sin6_port
                                           : reinterpret_cast<sockaddr_in*>(&bound)->sin_port);
}

// -1: errno says why not.
int listen_on(const addrinfo& at) {
  const int fd = socket(at.ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return -1;
  const int on = 1;
  setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  if (bind(fd, at.ai_addr, at.ai_addrlen) == 0 && listen(fd, kBacklog) == 0) return fd;
  const int why = errno;
  close(fd);
  errno = why;
  return -1;
}

// -1: errno says why not.
int listen_on(const std::string& unix_path) {
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return -1;
  sockaddr_un at{};
  at.sun_family = AF_UNIX;
  unix_path.copy(at.sun_path, sizeof(at.sun_path) - 1);
  unlink(unix_path.c_str());
  const mode_t before = umask(0177);  // the socket is born with mode 0600
  const bool bound = bind(fd, reinterpret_cast<const sockaddr*>(&at), sizeof(at)) == 0;
  int why = errno;
  umask(before);
  if (bound && listen(fd, kBacklog) == 0) return fd;
  if (bound) why = errno;
  close(fd);
  errno = why;
  return -1;
}

std::string text_of(const sockaddr_storage& address, socklen_t size) {
  if (address.ss_family == AF_UNIX) return "the Unix socket";
  char host[NI_MAXHOST] = "?", port[NI_MAXSERV] = "?";
  getnameinfo(reinterpret_cast<const sockaddr*>(&address), size, host, sizeof(host), port,
              sizeof(port), NI_NUMERICHOST | NI_NUMERICSERV);
  return address.ss_family == AF_INET6 ? absl::StrCat("[", host, "]:", port)
                                       : absl::StrCat(host, ":", port);
}

class Gate final : public FrontGate {
 public:
  explicit Gate(Visitors& visitors) : desk_(visitors) {}
  ~Gate() override { stop(); }

  absl::Status open(const Address& address) {
    RETURN_IF_ERROR(address.unix_path.empty() ? open_port(address) : open_path(address.unix_path));
    if (address.tls) {
      ASSIGN_OR_RETURN(auto sockets, tls_sockets(*address.tls));
      desk_.sockets = std::move(sockets);
    } else {
      desk_.sockets = plain_sockets();
    }
    rlimit files{};
    if (getrlimit(RLIMIT_NOFILE, &files) != 0) return absl::InternalError(std::strerror(errno));
    desk_.most_fd =
        static_cast<int>(std::min<rlim_t>(files.rlim_cur, kMostOpenFiles)) - 1 - kKeptFree;
    return absl::OkStatus();
  }

  [[nodiscard]] int port() const override { return port_; }

  void start(std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> server,
             int patience_ms) override {
    patience_ms_ = patience_ms;
    desk_.hand_on = [kept = std::shared_ptr(std::move(server))](int fd) {
      grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters connection;
      connection.fd = fd;
      kept->HandleNewConnection(&connection);
    };
    for (Fd& door : doors_) wait_at(door);
    thread_ = std::thread([this] {
      // OpenSSL writes to sockets without MSG_NOSIGNAL.
      sigset_t broken_pipe;
      sigemptyset(&broken_pipe);
      sigaddset(&broken_pipe, SIGPIPE);
      pthread_sigmask(SIG_BLOCK, &broken_pipe, nullptr);
      const auto work = asio::make_work_guard(desk_.loop);
      desk_.loop.run();
    });
  }

  void close_door() override {
    asio::post(desk_.loop, [this] {
      Error ignored;
      for (Fd& door : doors_) door.close(ignored);
    });
  }

  void stop() override {
    if (thread_.joinable()) {
      close_door();
      asio::post(desk_.loop, [this] {
        last_moment_ = std::chrono::steady_clock::now() + kLastWords;
        end_after_the_last();
      });
      thread_.join();
    }
    desk_.hand_on = nullptr;
  }

 private:
  absl::Status open_port(const Address& address) {
    const std::string place = address.target.substr(address.target.find(':') + 1);
    const std::size_t colon = place.rfind(':');
    std::string host = place.substr(0, colon);
    if (host.starts_with('[')) host = host.substr(1, host.size() - 2);
    ASSIGN_OR_RETURN(const auto found, resolve(host, place.substr(colon + 1)));
    for (const addrinfo* at = found.get(); at != nullptr; at = at->ai_next) {
      // The first one's port is that of all.
      if (port_ != 0) {
        const auto port = htons(static_cast<std::uint16_t>(port_));
        if (at->ai_family == AF_INET6)
          reinterpret_cast<sockaddr_in6*>(at->ai_addr)->sin6_port = port;
        if (at->ai_family == AF_INET) reinterpret_cast<sockaddr_in*>(at->ai_addr)->sin_port = port;
      }
      const int fd = listen_on(*at);
      if (fd < 0) continue;  // a name may stand for more than this machine has
      doors_.emplace_back(desk_.loop, fd);
      port_ = port_of(fd);
    }
    if (!doors_.empty()) return absl::OkStatus();
    if (errno == EADDRINUSE) return absl::AlreadyExistsError("another process listens there");
    return absl::InvalidArgumentError(std::strerror(errno));
  }

  absl::Status open_path(const std::string& path) {
    const int fd = listen_on(path);
    if (fd < 0) return absl::InvalidArgumentError(std::strerror(errno));
    doors_.emplace_back(desk_.loop, fd);
    return absl::OkStatus();
  }

  void wait_at(Fd& door) {
    if (!door.is_open()) return;
    door.async_wait(Fd::wait_read, [this, &door](Error error) {
      if (!error) take_from(door);
    });
  }
  void wait_a_moment(Fd& door) {
    auto timer = std::make_shared<asio::steady_timer>(desk_.loop, kPause);
    timer->async_wait([this, &door, timer](Error) { take_from(door); });
  }

  void take_from(Fd& door) {
    for (int i = 0; i < kConnectionsInATurn && door.is_open(); ++i) {
      // Whoever hangs up while its calls are open, and comes again, waits, and the others with it.
      if (desk_.totals.resets.is_over(now_s())) {
        if (const auto more = desk_.crowded.may_tell())
          log_line(LogLevel::warn, {},
                   "connections wait ({} times more before): too many calls were cancelled", *more);
        return wait_a_moment(door);
      }
      const bool taken = take(door.native_handle());
      if (out_of_descriptors_) return wait_a_moment(door);
      if (!taken) break;
    }
    wait_at(door);
  }

  static double now_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }

  // False: there is none, or none can be taken now. Whatever is wrong with one connection, the next
  // one may be right.
  bool take(int listening) {
    sockaddr_storage address{};
    socklen_t size = sizeof(address);
    const int fd = accept4(listening, reinterpret_cast<sockaddr*>(&address), &size,
                           SOCK_CLOEXEC | SOCK_NONBLOCK);
    out_of_descriptors_ =
        fd < 0 && (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM);
    if (out_of_descriptors_) {
      if (const auto more = waiting_.may_tell())
        log_line(LogLevel::warn, {}, "connections wait ({} times more before): {}", *more,
                 std::strerror(errno));
      return false;
    }
    if (fd < 0) return errno != EAGAIN;
    // The kernel gives the lowest number that is free.
    if (fd > desk_.most_fd) {
      close(fd);
      if (const auto more = refused_.may_tell())
        log_line(LogLevel::warn, {},
                 "refused: a connection ({} more before): {} files are open, which is the limit",
                 *more, desk_.most_fd);
      return true;
    }
    const int on = 1;
    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
    start_relay(desk_, fd, text_of(address, size), patience_ms_);
    return true;
  }

  void end_after_the_last() {
    if (desk_.under_way == 0 || std::chrono::steady_clock::now() >= last_moment_)
      return desk_.loop.stop();
    auto timer = std::make_shared<asio::steady_timer>(desk_.loop, std::chrono::milliseconds(5));
    timer->async_wait([this, timer](Error) { end_after_the_last(); });
  }

  OnceASecond waiting_, refused_;
  bool out_of_descriptors_ = false;
  int port_ = 0, patience_ms_ = 0;
  RelayDesk desk_;
  std::list<Fd> doors_;
  std::chrono::steady_clock::time_point last_moment_;
  std::thread thread_;
};

}  // namespace

void FrontGate::raise_open_files() {
  rlimit files{};
  if (getrlimit(RLIMIT_NOFILE, &files) != 0) return;
  files.rlim_cur = std::max(files.rlim_cur, std::min(files.rlim_max, kMostOpenFiles));
  setrlimit(RLIMIT_NOFILE, &files);
}

absl::StatusOr<std::unique_ptr<FrontGate>> FrontGate::open(const Address& address,
                                                           Visitors& visitors) {
  auto gate = std::make_unique<Gate>(visitors);
  RETURN_IF_ERROR(gate->open(address));
  return gate;
}

}  // namespace irsig
