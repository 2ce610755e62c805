#pragma once

#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "coordinator/client/certificate.h"

namespace irsig {

// The authority of one farm: a folder of mode 0700 with its key (ca.key), its certificate (ca.pem),
// every certificate that it has signed (issued/SERIAL.pem) and the list of revoked certificates
// (crl.pem). Keys are P-256. A file appears whole or not at all. Times are seconds since 1970; a
// certificate is valid from five minutes before its issue, because clocks differ.
//
// Errors: INVALID_ARGUMENT names the wrong name, host or file; ALREADY_EXISTS names a file that
// would be overwritten.

// Creates an authority in `folder`, which must be empty or not exist. Times in seconds.
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

// Revokes every certificate of this name, or the one with this serial number. Returns the number of
// certificates that were not revoked before. A coordinator started with --tls-crl refuses them as
// soon as the list is replaced. NOT_FOUND: the authority has signed no such certificate.
[[nodiscard]] absl::StatusOr<std::size_t> revoke_certificates(const std::string& folder,
                                                              const std::string& name_or_serial,
                                                              double now_unix_s);

struct IssuedCertificate {
  CertificateFacts facts;
  bool revoked = false;
};
// Returns all certificates that the authority has signed, by name and beginning of validity.
[[nodiscard]] absl::StatusOr<std::vector<IssuedCertificate>> issued_certificates(
    const std::string& folder);

}  // namespace irsig
