#pragma once

#include "absl/status/status.h"
#include "coordinator/client/address.h"

namespace irsig {

// Why a coordinator that listens there does not talk to us, which gRPC keeps to itself: a handshake
// of its own, of a few seconds at most. FAILED_PRECONDITION says what is wrong with whose
// certificate, or that one side alone speaks TLS. OK: the handshake succeeds, nobody listens there,
// or the connection ended without a reason (the coordinator ends just now).
[[nodiscard]] absl::Status check_handshake(const Address& coordinator);

}  // namespace irsig
