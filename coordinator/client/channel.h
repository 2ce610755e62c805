#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/support/status.h>

#include <chrono>
#include <memory>

#include "absl/status/status.h"
#include "coordinator/client/address.h"

namespace irsig {

// Keepalive of both ends: each pings after this silence and closes the connection after this wait.
// A hung peer (a stopped process, a lost link) is noticed within their sum, which matches the lease
// timeout. With shorter times, busy workers on a loaded machine were taken for dead.
inline constexpr int kKeepaliveMs = 4000;
inline constexpr int kKeepaliveTimeoutMs = 6000;
inline constexpr int kConnectTimeoutMs = 10000;
// One piece of a stream.
inline constexpr std::size_t kPieceBytes = 1 << 20;
// Size of a piece that a coordinator sends. A thousand workers may fetch the same sweep at once,
// and each of them needs a piece in memory.
inline constexpr std::size_t kFetchedPieceBytes = 64 << 10;
// The largest message that the coordinator accepts: a piece and its other fields. Larger objects
// are sent in pieces, whose memory is reserved before it is allocated.
inline constexpr int kMaxRequestBytes = 2 << 20;
// The largest answer: a job with 10^5 conditions.
inline constexpr int kMaxMessageBytes = 64 << 20;
// The largest serialized resolved sweep: 10^6 viewpoints need 30 MB, a radiosonde in 1000
// conditions 40 MB.
inline constexpr std::uint64_t kMaxSweepBytes = 64 << 20;
// The largest result: 2000 rows with spectra and thumbnails need 60 MB, 10^5 facets at 300 times
// 240 MB.
inline constexpr std::uint64_t kMaxResultBytes = 256 << 20;
// The largest asset: SQLite's default limit of a value is 10^9 bytes.
inline constexpr std::uint64_t kMaxAssetBytes = 1'000'000'000;

// Creates a channel that is never shared with another channel of this process. The channel
// reconnects within 2 s of the moment at which a server listens again.
[[nodiscard]] std::shared_ptr<grpc::Channel> connect(const Address& address);

// Returns the time at which a call with this time limit ends.
[[nodiscard]] std::chrono::system_clock::time_point deadline(double seconds);
inline void set_deadline(grpc::ClientContext& context, double seconds) {
  context.set_deadline(deadline(seconds));
}

// Silences gRPC's own lines on standard error: our messages report the same problems ("address
// already in use", three lines). GRPC_VERBOSITY in the environment restores the lines.
void silence_grpc();

// Converts a status; both libraries use the same numbers for their codes.
[[nodiscard]] absl::Status to_absl(const grpc::Status& status);
[[nodiscard]] grpc::Status to_grpc(const absl::Status& status);

// Returns true if the call may succeed when it is made again: the coordinator was not there.
[[nodiscard]] bool is_unreachable(const absl::Status& status);

}  // namespace irsig
