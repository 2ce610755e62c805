#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "schema/result.pb.h"
#include "schema/store/queue.h"
#include "schema/store/tables/database.h"

namespace irsig {

// Checks the result against its job and stores it in place of whatever lay at its places of the
// sweep; content_sha256: content.h. Does not touch the queue. INVALID_ARGUMENT: the result is not
// that of the job; then nothing was stored.
[[nodiscard]] absl::Status store_result(Database& database, const LeasedJob& job,
                                        const schema::JobResult& result,
                                        const std::string& worker_name,
                                        const std::string& content_sha256);

// Returns the largest numerical error of a result's rows, relative to their intensities; 0 without
// rows.
[[nodiscard]] double worst_relative_error(const schema::JobResult& result);

}  // namespace irsig
