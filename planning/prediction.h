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

// Returns one line, "predicted: 191 jobs, ...".
[[nodiscard]] std::string prediction_line(const StoredPrediction& prediction);

// Returns the prediction as a message for the program that submits the sweep.
[[nodiscard]] schema::Prediction as_message(const StoredPrediction& prediction);

// Stores a prediction in a database that no other program writes, and makes the file if it does not
// exist. Returns a message for the user, or an empty text.
[[nodiscard]] absl::StatusOr<std::string> store_in(const std::string& db_path,
                                                   const StoredPrediction& prediction);

}  // namespace irsig
