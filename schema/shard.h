#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "schema/job.pb.h"

namespace irsig {

// Viewpoints that the jobs of a sweep compute: all of them, unless the sweep is a shard
// (ResolvedSweep.shard).

// Returns the number of viewpoints that the jobs of the sweep compute.
[[nodiscard]] std::uint64_t shard_size(const schema::ResolvedSweep& sweep);

// Returns the index in ResolvedSweep.viewpoint of the i-th viewpoint that the jobs compute; i <
// shard_size.
[[nodiscard]] std::uint64_t shard_viewpoint(const schema::ResolvedSweep& sweep, std::uint64_t i);

// Returns true if the jobs of the sweep compute this viewpoint.
[[nodiscard]] bool in_shard(const schema::ResolvedSweep& sweep, std::uint64_t viewpoint);

// Returns the name of a shard for messages, e.g. "shard 1/3".
[[nodiscard]] std::string shard_name(const schema::Shard& shard);

// Returns OK if `submitted` may replace the sweep that a database stores under the same name. A
// shard replaces only itself, because the rows of the other viewpoints would be lost.
// INVALID_ARGUMENT: the message names the shard or sweep in the database.
[[nodiscard]] absl::Status check_may_replace(const schema::ResolvedSweep& stored,
                                             const schema::ResolvedSweep& submitted);

}  // namespace irsig
