#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "schema/farm.grpc.pb.h"

namespace irsig {

// Fetches the content that a coordinator stores under a hash, in pieces, on a channel of the
// caller. NOT_FOUND: the coordinator has no content of that hash. DATA_LOSS: the received bytes
// have another hash.
[[nodiscard]] absl::StatusOr<schema::ResolvedSweep> fetch_sweep(schema::Farm::StubInterface& farm,
                                                                const std::string& sweep_sha256,
                                                                double patience_s);
[[nodiscard]] absl::StatusOr<std::string> fetch_file(schema::Farm::StubInterface& farm,
                                                     const std::string& sha256, double patience_s);

}  // namespace irsig
