#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/store/tables/database.h"
#include "schema/store/tables/rows.h"

namespace irsig {

[[nodiscard]] absl::Status store_prediction(Database& database, const StoredPrediction& prediction);
[[nodiscard]] absl::StatusOr<std::optional<StoredPrediction>> find_prediction(
    Database& database, const std::string& sweep_sha256);
[[nodiscard]] absl::StatusOr<std::vector<StoredJobCost>> find_job_costs(Database& database,
                                                                        const std::string& sweep);
[[nodiscard]] absl::StatusOr<std::map<std::string, std::uint64_t>> find_rows_of_jobs(
    Database& database, const std::string& sweep);
[[nodiscard]] absl::StatusOr<StoredOutcome> find_outcome(Database& database,
                                                         const std::string& sweep);
// Implements StoreReader::visit_errors.
[[nodiscard]] absl::Status visit_errors(Database& database, const std::string& sweep,
                                        const std::function<void(const StoredSignature&)>& visit);
[[nodiscard]] absl::StatusOr<std::uint64_t> database_bytes(Database& database);

}  // namespace irsig
