#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "planning/sweep_pilot.h"
#include "schema/farm.pb.h"
#include "schema/store/tables/rows.h"

namespace irsig {

[[nodiscard]] StoredPrediction prediction_of(const SweepPilot& pilot,
                                             const schema::ResolvedSweep& sweep,
                                             std::uint32_t workers);

// "predicted: 191 jobs, ...", one line.
[[nodiscard]] std::string prediction_line(const StoredPrediction& prediction);

// Returns the prediction as a message for the program that submits the sweep.
[[nodiscard]] schema::Prediction as_message(const StoredPrediction& prediction);

// Into a database that nobody else writes; made if it does not exist.
// Returns what the user should know of it; empty: nothing.
[[nodiscard]] absl::StatusOr<std::string> store_in(const std::string& db_path,
                                                   const StoredPrediction& prediction);

}  // namespace irsig
