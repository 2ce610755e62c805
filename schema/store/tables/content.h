#pragma once

#include <string>

#include "schema/result.pb.h"

namespace irsig {

// Returns the SHA-256 of a result's content: of all its fields except build_id and seconds, in
// protobuf's deterministic encoding. Two workers of one determinism class give equal hashes for the
// same job. The hash holds for one version of the program's messages: an added field changes the
// hash.
[[nodiscard]] std::string content_sha256(const schema::JobResult& result);

// Like content_sha256(const JobResult&), without a copy, for a result that no other thread reads
// meanwhile.
[[nodiscard]] std::string content_sha256(schema::JobResult& result);

}  // namespace irsig
