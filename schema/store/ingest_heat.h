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
// temperatures of parts in place of those that earlier versions of the sweep left of its season.
// Neither touches the queue nor opens a savepoint, nor stores who computed it.
[[nodiscard]] absl::Status store_heat(Database& database, const LeasedJob& job,
                                      const schema::JobResult& result);

// Returns the number of rows of a run in the table: one for each part and time.
[[nodiscard]] std::int64_t computed_temperatures_of(const schema::HeatRun& run);

// Gives the job what a done job of another sweep with the same key has left, if one of this
// determinism class has; false: none has.
[[nodiscard]] absl::StatusOr<bool> copy_twin(Database& database, const LeasedJob& job,
                                             const std::string& determinism_class);

}  // namespace irsig
