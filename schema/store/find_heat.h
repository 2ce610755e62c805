#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/store/tables/database.h"
#include "schema/store/tables/filters.h"
#include "schema/store/tables/rows.h"

namespace irsig {

// Returns the outputs of the sweep's done heat jobs, in the order of its runs.
[[nodiscard]] absl::StatusOr<HeatOutputs> find_heat_outputs(Database& database,
                                                            const std::string& sweep);
[[nodiscard]] absl::StatusOr<std::vector<StoredTemperature>> find_computed_temperatures(
    Database& database, const TemperatureFilter& filter);
[[nodiscard]] absl::StatusOr<std::vector<StoredHeatJob>> find_heat_jobs(Database& database,
                                                                        const std::string& sweep);

}  // namespace irsig
