#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "coordinator/client/address.h"
#include "schema/assets.h"
#include "schema/farm.pb.h"

namespace irsig {

// Requests of a user to a coordinator. Each call connects and waits at most `patience_s` for an
// answer. UNAVAILABLE, naming the address: there is no answer.

// Sends a sweep, the files that it needs, the prediction of a pilot (null: none) and a priority
// (none: unchanged, 0 for a new sweep). Repeating the call changes nothing else. Once connected,
// the call waits longer for the answer, by the number of viewpoints.
[[nodiscard]] absl::StatusOr<schema::SubmitReply> submit(
    const Address& coordinator, const schema::ResolvedSweep& sweep, const Assets& assets,
    std::uint32_t physics_version, const schema::Prediction* prediction = nullptr,
    std::optional<int> priority = std::nullopt, double patience_s = 120);

[[nodiscard]] absl::StatusOr<schema::StatusReply> farm_status(const Address& coordinator,
                                                              double patience_s = 10);

// Cancels a sweep by name, by hash, or by the beginning (8 digits or more) of the hash. NOT_FOUND
// lists the existing sweeps.
[[nodiscard]] absl::StatusOr<schema::CancelReply> cancel(const Address& coordinator,
                                                         std::string_view sweep_name_or_sha256,
                                                         double patience_s = 30);

// Sets the priority by which workers choose between sweeps: named as for cancel(), priorities as in
// the store.
[[nodiscard]] absl::Status prioritize(const Address& coordinator,
                                      std::string_view sweep_name_or_sha256, int priority,
                                      double patience_s = 30);

// Returns the resolved sweep that a coordinator stores under this hash.
[[nodiscard]] absl::StatusOr<schema::ResolvedSweep> stored_sweep(const Address& coordinator,
                                                                 const std::string& sweep_sha256,
                                                                 double patience_s = 30);

}  // namespace irsig
