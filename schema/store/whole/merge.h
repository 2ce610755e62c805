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
  // The functions of jobs/check_resolved.h and jobs/keys/expand.h, on which the store does not
  // depend.
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

// Callback: given the number of rows read and the total, returns OK to continue; another status
// ends the merge and removes the file.
using MergeProgress = std::function<absl::Status(std::uint64_t rows, std::uint64_t of)>;

// Merges the done jobs of other databases into a new one. Sweeps of one name are one sweep: the
// whole sweep where sources hold its shards. Jobs that no source has done wait there, so that the
// sweep can be continued. Other sweeps are kept separately. The order of the sources changes no
// digest; the digest of all shards is that of the undivided run. Rows of an earlier version of a
// sweep, leases and failures are not copied.
//
// INVALID_ARGUMENT, naming both files: two definitions of one sweep, determinism classes or physics
// versions; a job done in both with different content (all fields except who, when and how long); a
// slice; unfinished sweeps of different determinism classes. Other errors: those of slice_database.
[[nodiscard]] absl::StatusOr<Merged> merge_databases(const MergeAsked& asked, const std::string& to,
                                                     const MergeProgress& progress = {});

}  // namespace irsig
