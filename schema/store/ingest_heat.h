#pragma once

#include "absl/status/status.h"
#include "schema/result.pb.h"
#include "schema/store/database.h"
#include "schema/store/queue.h"

namespace irsig {

// Checks the result of a heat job and stores it: the field as an asset under its SHA-256, and the
// temperatures of parts in place of those that earlier versions of the sweep left of its season.
// Neither touches the queue nor opens a savepoint, nor stores who computed it.
[[nodiscard]] absl::Status store_heat(Database& database, const LeasedJob& job,
                                      const schema::JobResult& result);

}  // namespace irsig
