#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace irsig {

// Mutual TLS: each side shows a certificate that the other's authority has signed.
struct TlsFiles {
  std::string certificate, key, ca;  // paths; none or all

  [[nodiscard]] bool any() const { return !(certificate.empty() && key.empty() && ca.empty()); }
};

// PEM texts in the form that gRPC expects.
struct TlsIdentity {
  std::string certificate, key, ca;
};

// Reads and checks the three files. The certificate (others of its chain may follow it) is valid
// today, and the authority has signed it. The key belongs to the certificate, has no password and
// is readable by its owner only. INVALID_ARGUMENT otherwise; the message names the file.
[[nodiscard]] absl::StatusOr<TlsIdentity> read_tls(const TlsFiles& files);

}  // namespace irsig
