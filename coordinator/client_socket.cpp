#include "coordinator/client_socket.h"

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "coordinator/client/openssl_handles.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

using Next = ClientSocket::Next;
using Step = ClientSocket::Step;

class PlainSocket final : public ClientSocket {
 public:
  explicit PlainSocket(int fd) : fd_(fd) {}

  Step shake_hands() override { return {Next::kGoOn}; }
  Step read(char* into, std::size_t room) override {
    return step_of(recv(fd_, into, room, MSG_DONTWAIT), Next::kAfterReading);
  }
  Step write(const char* from, std::size_t size) override {
    return step_of(send(fd_, from, size, MSG_DONTWAIT | MSG_NOSIGNAL), Next::kAfterWriting);
  }
  [[nodiscard]] std::string problem() const override { return ""; }
  [[nodiscard]] std::string certificate() const override { return ""; }

 private:
  static Step step_of(ssize_t moved, Next wait) {
    if (moved > 0) return {Next::kGoOn, static_cast<std::size_t>(moved)};
    const bool later = moved < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR);
    return {later ? wait : Next::kEnded};
  }

  int fd_;
};

using Session = std::unique_ptr<SSL, Freed<SSL_free>>;
using Context = std::unique_ptr<SSL_CTX, Freed<SSL_CTX_free>>;

class TlsSocket final : public ClientSocket {
 public:
  TlsSocket(Session session, int fd) : session_(std::move(session)) {
    if (session_) SSL_set_fd(session_.get(), fd);
  }

  Step shake_hands() override {
    if (!session_) return {Next::kEnded};
    ERR_clear_error();
    return step_of(SSL_accept(session_.get()));
  }
  Step read(char* into, std::size_t room) override {
    ERR_clear_error();
    return step_of(SSL_read(session_.get(), into, int_of(room)));
  }
  Step write(const char* from, std::size_t size) override {
    ERR_clear_error();
    return step_of(SSL_write(session_.get(), from, int_of(size)));
  }
  [[nodiscard]] std::string problem() const override { return problem_; }
  [[nodiscard]] std::string certificate() const override {
    const X509* shown = SSL_get0_peer_certificate(session_.get());
    const Bio text(BIO_new(BIO_s_mem()));
    if (shown == nullptr || !text || PEM_write_bio_X509(text.get(), shown) != 1) return "";
    char* bytes = nullptr;
    const long size = BIO_get_mem_data(text.get(), &bytes);
    return {bytes, static_cast<std::size_t>(size)};
  }

 private:
  static int int_of(std::size_t size) {
    return static_cast<int>(std::min<std::size_t>(size, INT_MAX));
  }

  Step step_of(int moved) {
    if (moved > 0) return {Next::kGoOn, static_cast<std::size_t>(moved)};
    switch (SSL_get_error(session_.get(), moved)) {
      case SSL_ERROR_WANT_READ:
        return {Next::kAfterReading};
      case SSL_ERROR_WANT_WRITE:
        return {Next::kAfterWriting};
      case SSL_ERROR_SSL:
        problem_ = reason();
        break;
      default:
        break;
    }
    ERR_clear_error();
    return {Next::kEnded};
  }
  std::string reason() const {
    const char* text = ERR_reason_error_string(ERR_peek_error());
    const std::string why = text == nullptr ? "an unknown error" : text;
    const long verified = SSL_get_verify_result(session_.get());
    if (verified == X509_V_OK) return why;
    return absl::StrCat(why, ": ", X509_verify_cert_error_string(verified));
  }

  Session session_;
  std::string problem_;
};

// HTTP/2, or no connection (RFC 9113, section 3.2).
int choose_http2(SSL* /*session*/, const unsigned char** chosen, unsigned char* chosen_size,
                 const unsigned char* offered, unsigned int offered_size, void* /*context*/) {
  static constexpr unsigned char kHttp2[] = {2, 'h', '2'};
  unsigned char* found = nullptr;
  if (SSL_select_next_proto(&found, chosen_size, kHttp2, sizeof(kHttp2), offered, offered_size) !=
      OPENSSL_NPN_NEGOTIATED)
    return SSL_TLSEXT_ERR_ALERT_FATAL;
  *chosen = found;
  return SSL_TLSEXT_ERR_OK;
}

class TlsSockets final : public ClientSockets {
 public:
  explicit TlsSockets(Context context) : context_(std::move(context)) {}
  std::unique_ptr<ClientSocket> make(int fd) override {
    return std::make_unique<TlsSocket>(Session(SSL_new(context_.get())), fd);
  }

 private:
  Context context_;
};

class PlainSockets final : public ClientSockets {
 public:
  std::unique_ptr<ClientSocket> make(int fd) override { return std::make_unique<PlainSocket>(fd); }
};

}  // namespace

std::unique_ptr<ClientSockets> plain_sockets() { return std::make_unique<PlainSockets>(); }

absl::StatusOr<std::unique_ptr<ClientSockets>> tls_sockets(const TlsIdentity& tls) {
  Context context(SSL_CTX_new(TLS_server_method()));
  if (!context) return absl::InternalError("OpenSSL has no memory");
  SSL_CTX_set_min_proto_version(context.get(), TLS1_2_VERSION);
  // For TLS 1.2, only ciphers that HTTP/2 does not prohibit (RFC 9113, appendix A).
  SSL_CTX_set_cipher_list(context.get(), "ECDHE+AESGCM:ECDHE+CHACHA20");
  SSL_CTX_set_options(context.get(), SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_COMPRESSION |
                                         SSL_OP_NO_TICKET | SSL_OP_IGNORE_UNEXPECTED_EOF);
  // Nothing is resumed: a handshake shows the certificate each time.
  SSL_CTX_set_num_tickets(context.get(), 0);
  SSL_CTX_set_session_cache_mode(context.get(), SSL_SESS_CACHE_OFF);
  SSL_CTX_set_mode(context.get(), SSL_MODE_RELEASE_BUFFERS | SSL_MODE_ENABLE_PARTIAL_WRITE |
                                      SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER);
  SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER | SSL_VERIFY_FAIL_IF_NO_PEER_CERT, nullptr);
  SSL_CTX_set_alpn_select_cb(context.get(), choose_http2, nullptr);
  RETURN_IF_ERROR(use_identity(tls, context.get()));
  for (const Certificate& authority : certificates_of(tls.ca))
    SSL_CTX_add_client_CA(context.get(), authority.get());
  return std::make_unique<TlsSockets>(std::move(context));
}

}  // namespace irsig
