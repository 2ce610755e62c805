#pragma once

#include <grpcpp/server_context.h>

#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "coordinator/client/certificate.h"
#include "coordinator/farm.h"
#include "coordinator/visitors.h"

namespace irsig {

// Decides which caller may make which call. Over TLS, each call is checked against the caller's
// certificate: its roles, its dates, and the authority's list of revoked certificates. Without TLS
// (a Unix socket of mode 0600, --insecure-loopback, --insecure-network) every connected caller may
// make every call. Thread-safe.
class Doorkeeper {
 public:
  // Creates a doorkeeper. tls: null without TLS. crl_path: the revocation list, read again whenever
  // the file has changed; empty: no list. INVALID_ARGUMENT: the list cannot be read, or the
  // authority has not signed it.
  static absl::StatusOr<std::unique_ptr<Doorkeeper>> make(std::shared_ptr<const TlsIdentity> tls,
                                                          const Visitors& visitors,
                                                          std::string crl_path, Clock unix_clock);

  // Checks that the caller has one of the roles in `enough`. PERMISSION_DENIED: the caller has none
  // of them. UNAUTHENTICATED: the certificate was revoked, or has expired since the connection
  // began. Both are logged with the call, the caller and the reason. CANCELLED: the connection has
  // ended meanwhile.
  absl::Status admit(const grpc::ServerContextBase& context, std::string_view call,
                     const std::set<Role>& enough);

  // Returns warnings about certificates that expire soon (of the coordinator, the authority, and
  // callers of the last hour), and about a revocation list that cannot be read. Each warning is
  // logged once a day.
  std::vector<std::string> warnings();

 private:
  struct Caller {
    CertificateFacts facts;
    double seen_unix_s;
  };
  Doorkeeper(std::shared_ptr<const TlsIdentity> tls, const Visitors& visitors, std::string crl_path,
             Clock unix_clock)
      : tls_(std::move(tls)),
        visitors_(visitors),
        crl_path_(std::move(crl_path)),
        unix_clock_(std::move(unix_clock)) {}
  absl::Status look(const std::string& pem, std::string_view call, const std::set<Role>& enough,
                    std::string& who);
  absl::Status read_revocations(double now_unix_s);
  std::vector<std::string> find_warnings(double now_unix_s);
  void log_warnings(double now_unix_s);
  void log_refusal(std::string_view call, const std::string& who, const absl::Status& why,
                   double now_unix_s);

  const std::shared_ptr<const TlsIdentity> tls_;
  const Visitors& visitors_;
  const std::string crl_path_;
  const Clock unix_clock_;

  std::mutex mutex_;
  std::map<std::string, Caller> callers_;  // by certificate
  std::set<std::string> revoked_;
  std::string crl_stamp_, crl_problem_;
  double crl_looked_unix_s_ = -1e9, warned_unix_s_ = -1e9;
  std::map<std::string, double> logged_;  // warning -> when
  double refusals_since_unix_s_ = -1e9;
  std::uint64_t refusals_ = 0, refusals_untold_ = 0;
};

}  // namespace irsig
