#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/job.pb.h"
#include "schema/store/tables/rows.h"

namespace irsig {

// Results of one sweep of the pilot in the database.
struct PilotStage {
  std::vector<StoredSignature> rows;
  std::vector<StoredLedger> ledgers;  // [row]
  std::vector<StoredJobCost> jobs;
  std::vector<StoredProfileRow> profile;

  [[nodiscard]] double cpu_s(std::uint64_t viewpoint) const {
    double sum = 0;
    for (const StoredJobCost& job : jobs) sum += job.viewpoint_index == viewpoint ? job.cpu_s : 0;
    return sum;
  }
};

// Computes a pilot's sweeps.
class PilotFarm {
 public:
  virtual ~PilotFarm() = default;
  // Computes these sweeps, whose names are made different here, one after the other.
  virtual absl::StatusOr<std::vector<PilotStage>> run(
      std::vector<schema::ResolvedSweep> sweeps) = 0;
  // Returns the size of the database in which they are stored. [bytes]
  [[nodiscard]] virtual absl::StatusOr<double> bytes() const = 0;
  [[nodiscard]] virtual double cpu_s() const = 0;   // of all jobs so far
  [[nodiscard]] virtual double wall_s() const = 0;  // of the last run
};

// Starts a coordinator and one worker on a database that is deleted afterwards. The jobs share the
// machine only with the plan itself. `assets` must outlive the farm.
[[nodiscard]] absl::StatusOr<std::unique_ptr<PilotFarm>> start_pilot_farm(const Assets& assets);

}  // namespace irsig
