#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/job.pb.h"
#include "schema/store/tables/database.h"
#include "schema/store/tables/rows.h"

namespace irsig {

// Implements StoreWriter::add_sweep. INVALID_ARGUMENT: the jobs do not cover the sweep's viewpoints
// x conditions x bands exactly once, or names or viewpoints come twice; then nothing was changed.
[[nodiscard]] absl::StatusOr<AddedJobs> store_sweep(Database& database,
                                                    const schema::ResolvedSweep& sweep,
                                                    const std::string& sweep_sha256,
                                                    const std::vector<schema::JobSpec>& jobs,
                                                    const std::vector<Asset>& assets);

// Unit vector from target to sensor, body frame (x forward, y starboard, z down).
struct UnitVector {
  double x, y, z;
};
[[nodiscard]] UnitVector unit_vector(double aspect_azimuth_deg, double aspect_elevation_deg);

}  // namespace irsig
