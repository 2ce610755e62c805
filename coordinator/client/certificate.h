#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "coordinator/client/tls.h"

namespace irsig {

// Permissions of a certificate's holder at a coordinator.
enum class Role {
  kSubmit,  // submit and cancel sweeps, ask how far they are
  kWork,    // compute jobs
  kRead     // ask how far sweeps are, fetch them
};
inline constexpr Role kRoles[] = {Role::kSubmit, Role::kWork, Role::kRead};
[[nodiscard]] std::string_view role_name(Role role);
// Returns the role of this name. INVALID_ARGUMENT: there is no such role.
[[nodiscard]] absl::StatusOr<Role> role_by_name(std::string_view name);
// Returns the names of the roles, joined by `word`: "submit or read".
[[nodiscard]] std::string role_list(const std::set<Role>& roles, std::string_view word);

// Returns the object identifier of a role. A role is a key purpose in the certificate's extended
// key usage (RFC 5280, 4.2.1.12): the UUID acc0ccce-a7ea-482a-8189-ffc958fec560 below 2.25 (ITU-T
// X.667), then 1, 2 or 3 for submit, work or read.
[[nodiscard]] std::string role_oid(Role role);

// Facts that a certificate states about its holder.
struct CertificateFacts {
  std::string name;        // its common name; may be anything that an authority has signed
  std::string serial_hex;  // lower case
  std::set<Role> roles;
  bool of_a_server = false;  // may be shown by a coordinator
  double valid_from_unix_s = 0, valid_until_unix_s = 0;
};
// Reads the first certificate of a PEM text. INVALID_ARGUMENT: the text has no certificate.
[[nodiscard]] absl::StatusOr<CertificateFacts> certificate_facts(const std::string& pem);

// Returns a warning about a certificate that expires soon ("expires in 3 days", "has expired"):
// less than 14 days, or less than a tenth of its validity, is left. Empty: no warning is due.
[[nodiscard]] std::string running_out(const CertificateFacts& facts, double now_unix_s);
// Returns one warning for each certificate that expires soon: the identity's own and the
// authority's.
[[nodiscard]] std::vector<std::string> running_out(const TlsIdentity& identity, double now_unix_s);

// Returns the serial numbers (as above) that an authority has revoked. `crl` is a revocation list
// in PEM, signed by one of the authorities in `ca`. INVALID_ARGUMENT: `crl` is not such a list.
[[nodiscard]] absl::StatusOr<std::set<std::string>> revoked_serials(const std::string& crl,
                                                                    const std::string& ca);

}  // namespace irsig
