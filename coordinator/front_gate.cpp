#include "coordinator/front_gate.h"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "coordinator/client/farm_log.h"
#include "coordinator/once_a_second.h"

namespace irsig {
namespace {

// Of 40 kB each while their handshake lasts (tests/fault/half_open_test.py).
constexpr rlim_t kMostOpenFiles = 16384;
// For the database, its journals, submitted files, lists of certificates.
constexpr int kKeptFree = 64;
constexpr int kBacklog = 1024;
constexpr int kPause_ms = 100;  // where the whole machine has no more

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

}  // namespace

void FrontGate::raise_open_files() {
  rlimit files{};
  if (getrlimit(RLIMIT_NOFILE, &files) != 0) return;
  files.rlim_cur = std::max(files.rlim_cur, std::min(files.rlim_max, kMostOpenFiles));
  setrlimit(RLIMIT_NOFILE, &files);
}

absl::StatusOr<std::unique_ptr<FrontGate>> FrontGate::open(const std::string& host_port) {
  const std::size_t colon = host_port.rfind(':');
  std::string host = host_port.substr(0, colon);
  if (host.starts_with('[')) host = host.substr(1, host.size() - 2);
  const auto found = resolve(host, host_port.substr(colon + 1));
  if (!found.ok()) return found.status();
  std::unique_ptr<FrontGate> gate(new FrontGate);
  for (const addrinfo* at = found->get(); at != nullptr; at = at->ai_next) {
    // The first one's port is that of all.
    if (gate->port_ != 0) {
      const auto port = htons(static_cast<std::uint16_t>(gate->port_));
      if (at->ai_family == AF_INET6) reinterpret_cast<sockaddr_in6*>(at->ai_addr)->sin6_port = port;
      if (at->ai_family == AF_INET) reinterpret_cast<sockaddr_in*>(at->ai_addr)->sin_port = port;
    }
    const int fd = listen_on(*at);
    if (fd < 0) continue;  // a name may stand for more than this machine has
    gate->listening_.push_back(fd);
    gate->port_ = port_of(fd);
  }
  if (gate->listening_.empty()) {
    if (errno == EADDRINUSE) return absl::AlreadyExistsError("another process listens there");
    return absl::InvalidArgumentError(std::strerror(errno));
  }
  gate->wake_ = eventfd(0, EFD_CLOEXEC);
  rlimit files{};
  if (gate->wake_ < 0 || getrlimit(RLIMIT_NOFILE, &files) != 0)
    return absl::InternalError(std::strerror(errno));
  gate->most_fd_ =
      static_cast<int>(std::min<rlim_t>(files.rlim_cur, kMostOpenFiles)) - 1 - kKeptFree;
  return gate;
}

void FrontGate::start(std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> server) {
  server_ = std::move(server);
  thread_ = std::thread([this] { run(); });
}

void FrontGate::stop() {
  if (thread_.joinable()) {
    const std::uint64_t one = 1;
    if (write(wake_, &one, sizeof(one)) == sizeof(one)) thread_.join();
  }
  for (const int fd : listening_) close(fd);
  listening_.clear();
  if (wake_ >= 0) close(wake_);
  wake_ = -1;
  server_.reset();
}

void FrontGate::run() {
  std::vector<pollfd> watched = {{wake_, POLLIN, 0}};
  for (const int fd : listening_) watched.push_back({fd, POLLIN, 0});
  while (true) {
    if (poll(watched.data(), watched.size(), -1) < 0) continue;
    if (watched[0].revents != 0) return;
    for (std::size_t i = 1; i < watched.size(); ++i)
      if (watched[i].revents != 0) take(watched[i].fd);
  }
}

// Whatever is wrong with one connection, the next one may be right.
void FrontGate::take(int listening) {
  const int fd = accept4(listening, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (fd < 0) {
    if (errno != EMFILE && errno != ENFILE && errno != ENOBUFS && errno != ENOMEM) return;
    if (const auto more = waiting_.may_tell())
      log_line(LogLevel::warn, {}, "connections wait ({} times more before): {}", *more,
               std::strerror(errno));
    pollfd end{wake_, POLLIN, 0};
    poll(&end, 1, kPause_ms);
    return;
  }
  // The kernel gives the lowest number that is free.
  if (fd > most_fd_) {
    close(fd);
    if (const auto more = refused_.may_tell())
      log_line(LogLevel::warn, {},
               "refused: a connection ({} more before): there are {}, which is the limit", *more,
               most_fd_);
    return;
  }
  const int on = 1;
  setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
  grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters connection;
  connection.listener_fd = listening;
  connection.fd = fd;
  server_->HandleNewConnection(&connection);
}

}  // namespace irsig
