#pragma once

#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "coordinator/client/certificate.h"

namespace irsig {

// The authority of one farm: a folder of mode 0700 that holds its key (ca.key), its certificate
// (ca.pem), every certificate that it has signed (issued/SERIAL.pem) and the list of those that it
// has revoked (crl.pem). Keys are P-256; files appear whole or not at all. Times: seconds since
// 1970; a certificate is valid from five minutes before, since clocks differ.
//
// Errors: INVALID_ARGUMENT names the name, host or file that is wrong; ALREADY_EXISTS a file that
// would be written over.

// The folder must not exist, or be empty.
[[nodiscard]] absl::Status make_authority(const std::string& folder, const std::string& name,
                                          double now_unix_s, double valid_s);

struct CertificateWish {
  std::string name;                // of the files, and its common name: letters, digits, . _ -
  std::vector<std::string> hosts;  // names or addresses: a coordinator's, that is reached there
  std::set<Role> roles;            // of a worker or user
};
// Writes NAME.pem and NAME.key (mode 0600) into `out_folder`.
[[nodiscard]] absl::Status issue_certificate(const std::string& folder, const CertificateWish& wish,
                                             const std::string& out_folder, double now_unix_s,
                                             double valid_s);

// Every certificate of this name, or the one of this serial number; how many were not revoked
// before. NOT_FOUND: it has signed none. A coordinator that was started with --tls-crl refuses them
// from the moment at which the list is replaced.
[[nodiscard]] absl::StatusOr<std::size_t> revoke_certificates(const std::string& folder,
                                                              const std::string& name_or_serial,
                                                              double now_unix_s);

struct IssuedCertificate {
  CertificateFacts facts;
  bool revoked = false;
};
// All that it has signed, by name and beginning of validity.
[[nodiscard]] absl::StatusOr<std::vector<IssuedCertificate>> issued_certificates(
    const std::string& folder);

}  // namespace irsig
