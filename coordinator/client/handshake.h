#pragma once

#include "absl/status/status.h"
#include "coordinator/client/address.h"

namespace irsig {

// Finds out why a coordinator that listens at this address refuses the connection, by a separate
// TLS handshake of at most a few seconds; gRPC does not report the reason. FAILED_PRECONDITION: the
// message names the certificate and its problem, or states that only one side uses TLS. OK: the
// handshake succeeds, nothing listens at the address, or the connection ended without a reason (the
// coordinator is shutting down).
[[nodiscard]] absl::Status check_handshake(const Address& coordinator);

}  // namespace irsig
