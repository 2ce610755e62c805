#include "coordinator/client/handshake.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "coordinator/client/openssl_handles.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

constexpr int kPatience_s = 3;  // for each step

class Socket {
 public:
  Socket(const std::string& host, const std::string& port) {
    addrinfo wanted{}, *found = nullptr;
    wanted.ai_socktype = SOCK_STREAM;
    if (getaddrinfo(host.c_str(), port.c_str(), &wanted, &found) != 0) return;
    for (const addrinfo* at = found; at != nullptr && fd_ < 0; at = at->ai_next) open(*at);
    freeaddrinfo(found);
  }
  ~Socket() {
    if (fd_ >= 0) close(fd_);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  [[nodiscard]] int fd() const { return fd_; }  // -1: nobody is there

 private:
  void open(const addrinfo& at) {
    fd_ = socket(at.ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (fd_ < 0) return;
    const timeval patience{kPatience_s, 0};  // of connect(), too: socket(7)
    setsockopt(fd_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof(patience));
    setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    if (connect(fd_, at.ai_addr, at.ai_addrlen) == 0) return;
    close(fd_);
    fd_ = -1;
  }

  int fd_ = -1;
};

// A coordinator that hangs up first must not end this program.
class IgnoredSigpipe {
 public:
  IgnoredSigpipe() : before_(std::signal(SIGPIPE, SIG_IGN)) {}
  ~IgnoredSigpipe() { std::signal(SIGPIPE, before_); }
  IgnoredSigpipe(const IgnoredSigpipe&) = delete;
  IgnoredSigpipe& operator=(const IgnoredSigpipe&) = delete;

 private:
  void (*before_)(int);
};

using Context = std::unique_ptr<SSL_CTX, Freed<SSL_CTX_free>>;
using Session = std::unique_ptr<SSL, Freed<SSL_free>>;

void expect_host(const std::string& host, SSL* session) {
  X509_VERIFY_PARAM* param = SSL_get0_param(session);
  if (X509_VERIFY_PARAM_set1_ip_asc(param, host.c_str()) == 1) return;
  SSL_set1_host(session, host.c_str());
  SSL_set_tlsext_host_name(session, host.c_str());
}

enum class Outcome { kWorks, kUnknown, kHungUpOnUs };

// Reads the first byte after a handshake of TLS 1.3. The other side checks our certificate only
// after our handshake is done: gRPC then closes the connection if it refuses the certificate, and
// sends its first bytes otherwise.
Outcome first_byte(SSL* session) {
  char byte = 0;
  const int got = SSL_read(session, &byte, 1);
  if (got == 1) return Outcome::kWorks;
  const int error = SSL_get_error(session, got);
  const bool timed_out = error == SSL_ERROR_WANT_READ;
  return timed_out ? Outcome::kUnknown : Outcome::kHungUpOnUs;
}

absl::Status refused(const Address& coordinator, const std::string& what) {
  return absl::FailedPreconditionError(
      absl::StrCat("the coordinator at ", coordinator.text, " ", what));
}

// Whoever shows a certificate speaks TLS.
absl::Status check_plain(const Address& coordinator, SSL* session) {
  (void)SSL_connect(session);
  if (SSL_get0_peer_certificate(session) == nullptr) return absl::OkStatus();
  return refused(coordinator, "speaks TLS only: give --tls-cert, --tls-key and --tls-ca");
}

absl::StatusOr<Outcome> check_tls(const Address& coordinator, SSL* session) {
  expect_host(coordinator.host, session);
  if (SSL_connect(session) == 1) return first_byte(session);
  if (const long verified = SSL_get_verify_result(session); verified != X509_V_OK)
    return refused(coordinator, absl::StrCat("shows a certificate that is not accepted: ",
                                             X509_verify_cert_error_string(verified)));
  const unsigned long error = ERR_peek_error();
  const int reason = ERR_GET_REASON(error);
  if (ERR_GET_LIB(error) == ERR_LIB_SSL &&
      (reason == SSL_R_WRONG_VERSION_NUMBER || reason == SSL_R_PACKET_LENGTH_TOO_LONG))
    return refused(coordinator,
                   "does not speak TLS: start it with --tls-cert, --tls-key and --tls-ca");
  return Outcome::kUnknown;
}

absl::StatusOr<Outcome> try_once(const Address& coordinator) {
  const Socket socket(coordinator.host, coordinator.text.substr(coordinator.text.rfind(':') + 1));
  if (socket.fd() < 0) return Outcome::kUnknown;
  const Context context(SSL_CTX_new(TLS_client_method()));
  if (coordinator.tls) {
    SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER, nullptr);
    if (!use_identity(*coordinator.tls, context.get()).ok()) return Outcome::kUnknown;
  }
  const Session session(SSL_new(context.get()));
  constexpr unsigned char kHttp2[] = {2, 'h', '2'};
  SSL_set_alpn_protos(session.get(), kHttp2, sizeof(kHttp2));
  SSL_set_fd(session.get(), socket.fd());
  ERR_clear_error();
  absl::StatusOr<Outcome> out = Outcome::kUnknown;
  if (coordinator.tls) {
    out = check_tls(coordinator, session.get());
  } else if (auto plain = check_plain(coordinator, session.get()); !plain.ok()) {
    out = plain;
  }
  ERR_clear_error();
  return out;
}

}  // namespace

absl::Status check_handshake(const Address& coordinator) {
  if (!coordinator.unix_path.empty()) return absl::OkStatus();
  const IgnoredSigpipe quietly;
  // A coordinator that ends hangs up, too, but not twice.
  for (int attempt = 0; attempt < 2; ++attempt) {
    ASSIGN_OR_RETURN(const auto outcome, try_once(coordinator));
    if (outcome != Outcome::kHungUpOnUs) return absl::OkStatus();
  }
  return refused(coordinator,
                 "does not accept our certificate: it has expired, or another authority than the "
                 "coordinator's --tls-ca has signed it");
}

}  // namespace irsig
