#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "schema/store/reader.h"

namespace irsig {

struct MergeAsked {
  std::vector<std::string> from;
  // jobs/check_resolved.h and jobs/keys/expand.h, which the store does not know.
  std::function<absl::StatusOr<std::vector<schema::JobSpec>>(const schema::ResolvedSweep&,
                                                             int physics_version)>
      jobs;
  int physics_version = 0;  // of sweeps of which nothing is done
};

struct Merged {
  struct Sweep {
    std::string name;
    std::uint64_t rows, jobs, done;
    std::uint64_t left_behind;  // rows of an earlier version of the sweep, in all sources
  };
  std::vector<Sweep> sweep;  // in the order in which they were met
  std::string digest;        // StoreReader::digest
};

// Callback: given the numbers of rows read and in all, returns OK to continue; another status ends
// the merge, and leaves nothing.
using MergeProgress = std::function<absl::Status(std::uint64_t rows, std::uint64_t of)>;

// Makes a database of the done jobs of others. Sweeps of one name are one sweep: the whole one,
// where sources hold shards of it; what no source has done waits there, so that the sweep can be
// gone on with. Other sweeps stand side by side. The order of the sources changes no digest; that
// of all shards is that of the undivided run. Rows of an earlier version of a sweep, leases and
// failures stay behind.
//
// INVALID_ARGUMENT, naming both files: two definitions of one sweep, determinism classes or physics
// versions; a job that is done in both with different content (all of it but who, when and how
// long); a slice; unfinished sweeps of different determinism classes. Else as of slice_database.
[[nodiscard]] absl::StatusOr<Merged> merge_databases(const MergeAsked& asked, const std::string& to,
                                                     const MergeProgress& progress = {});

}  // namespace irsig
