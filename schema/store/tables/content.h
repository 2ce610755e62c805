#pragma once

#include <string>

#include "schema/result.pb.h"

namespace irsig {

// The SHA-256 of what a result says: of all its fields but who computed it and how long that took
// (build_id, seconds), in protobuf's deterministic encoding. Two workers of one determinism class
// give the same one for the same job. As digests are, it is that of one version of the program's
// messages: a field that is added changes it.
[[nodiscard]] std::string content_sha256(const schema::JobResult& result);

// Like content_sha256(const JobResult&), without a copy, for a result that no other thread reads
// meanwhile.
[[nodiscard]] std::string content_sha256(schema::JobResult& result);

}  // namespace irsig
