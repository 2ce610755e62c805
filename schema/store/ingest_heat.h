#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "schema/job.pb.h"
#include "schema/result.pb.h"
#include "schema/store/queue.h"
#include "schema/store/tables/database.h"

namespace irsig {

// Checks the result of a heat job and stores it: the field as an asset under its SHA-256, and the
// temperatures of parts in place of those that earlier versions of the sweep stored for its season.
// Does not change the queue, open a savepoint, or store who computed it.
[[nodiscard]] absl::Status store_heat(Database& database, const LeasedJob& job,
                                      const schema::JobResult& result);

// Returns the number of rows of a run in the table: one for each part and time.
[[nodiscard]] std::int64_t computed_temperatures_of(const schema::HeatRun& run);

// Copies the output of a done job of another sweep with the same key to this job, if there is one
// of this determinism class. Returns false if there is none.
[[nodiscard]] absl::StatusOr<bool> copy_twin(Database& database, const LeasedJob& job,
                                             const std::string& determinism_class);

}  // namespace irsig
