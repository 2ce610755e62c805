#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "schema/job.pb.h"

namespace irsig {

// Of a sweep that is no shard (ResolvedSweep.shard) these are all viewpoints.

// How many viewpoints the jobs of the sweep compute.
[[nodiscard]] std::uint64_t shard_size(const schema::ResolvedSweep& sweep);

// The i-th of them, i < shard_size, as an index of ResolvedSweep.viewpoint.
[[nodiscard]] std::uint64_t shard_viewpoint(const schema::ResolvedSweep& sweep, std::uint64_t i);

// Whether this viewpoint is one of them.
[[nodiscard]] bool in_shard(const schema::ResolvedSweep& sweep, std::uint64_t viewpoint);

// "shard 1/3".
[[nodiscard]] std::string shard_name(const schema::Shard& shard);

// Whether a database may take `submitted` in place of what it holds under the same name. A shard
// takes no place but its own: the rows of the other viewpoints would be lost. INVALID_ARGUMENT says
// which of them there is.
[[nodiscard]] absl::Status check_may_replace(const schema::ResolvedSweep& stored,
                                             const schema::ResolvedSweep& submitted);

}  // namespace irsig
