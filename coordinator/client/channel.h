#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/support/status.h>

#include <chrono>
#include <memory>

#include "absl/status/status.h"
#include "coordinator/client/address.h"

namespace irsig {

// Both ends ping after this silence and give up after this wait: a hung peer (a stopped process, a
// lost link) is noticed within their sum, which matches the lease timeout. Shorter ones took busy
// workers on a loaded machine for dead.
inline constexpr int kKeepaliveMs = 4000;
inline constexpr int kKeepaliveTimeoutMs = 6000;
inline constexpr int kConnectTimeoutMs = 10000;
// One piece of a stream.
inline constexpr std::size_t kPieceBytes = 1 << 20;
// One of what a coordinator sends: a thousand workers may fetch the same sweep at once, and a piece
// is in memory once for each of them.
inline constexpr std::size_t kFetchedPieceBytes = 64 << 10;
// The largest message that the coordinator takes: a piece and what goes with it. Larger things come
// in pieces, whose memory is accounted for before it is taken.
inline constexpr int kMaxRequestBytes = 2 << 20;
// The largest answer: a job with 10^5 conditions.
inline constexpr int kMaxMessageBytes = 64 << 20;
// A serialized resolved sweep: 10^6 viewpoints take 30 MB, a radiosonde in 1000 conditions 40 MB.
inline constexpr std::uint64_t kMaxSweepBytes = 64 << 20;
// A result: 2000 rows with spectra and thumbnails take 60 MB, 10^5 facets at 300 times 240 MB.
inline constexpr std::uint64_t kMaxResultBytes = 256 << 20;
// The largest asset: SQLite's default limit of a value is 10^9 bytes.
inline constexpr std::uint64_t kMaxAssetBytes = 1'000'000'000;

// Creates a channel that is never shared with another channel of this process. The channel
// reconnects within 2 s of the moment at which a server listens again.
[[nodiscard]] std::shared_ptr<grpc::Channel> connect(const Address& address);

// Returns the time at which a call ends that may take so many seconds from now.
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
