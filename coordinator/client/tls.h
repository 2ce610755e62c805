#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace irsig {

// Mutual TLS: each side shows a certificate that the other's authority has signed.
struct TlsFiles {
  std::string certificate, key, ca;  // paths; none or all

  [[nodiscard]] bool any() const { return !(certificate.empty() && key.empty() && ca.empty()); }
};

// PEM, as gRPC wants it.
struct TlsIdentity {
  std::string certificate, key, ca;
};

// Reads and checks the three: the certificate (others of its chain may follow it) is valid today,
// its key belongs to it, has no password and can be read by its owner only, and the authority has
// signed it. INVALID_ARGUMENT, naming the file.
[[nodiscard]] absl::StatusOr<TlsIdentity> read_tls(const TlsFiles& files);

}  // namespace irsig
