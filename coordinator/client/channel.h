#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/support/status.h>

#include <memory>

#include "absl/status/status.h"
#include "coordinator/client/address.h"

namespace irsig {

// Both ends ping after this silence and give up after this wait: a hung peer (a stopped process, a
// lost link) is noticed within their sum, which matches the lease timeout. Shorter ones took busy
// workers on a loaded machine for dead.
inline constexpr int kKeepaliveMs = 4000;
inline constexpr int kKeepaliveTimeoutMs = 6000;
// One piece of a stream, and the largest single message (a resolved sweep of 10^6 viewpoints).
inline constexpr std::size_t kPieceBytes = 1 << 20;
inline constexpr int kMaxMessageBytes = 64 << 20;
// The largest asset or result: SQLite's default limit of a value is 10^9 bytes.
inline constexpr std::uint64_t kMaxStreamBytes = 1'000'000'000;

// A channel of its own (never shared with another one of this process) that reconnects within 2 s.
[[nodiscard]] std::shared_ptr<grpc::Channel> connect(const Address& address);

// gRPC reports on standard error what our own messages say better ("address already in use", three
// lines); GRPC_VERBOSITY in the environment brings its lines back.
void silence_grpc();

// The two libraries number their codes alike.
[[nodiscard]] absl::Status to_absl(const grpc::Status& status);
[[nodiscard]] grpc::Status to_grpc(const absl::Status& status);

// Whether the call may succeed when it is made again: the coordinator was not there.
[[nodiscard]] bool is_unreachable(const absl::Status& status);

}  // namespace irsig
