#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "schema/store/tables/database.h"
#include "schema/store/tables/rows.h"

namespace irsig {

// The only code that reads the bytes of assets, except `examine`, which reads all of them. Each
// read checks the bytes against the SHA-256 that is the asset's name.

// Reads the bytes of an asset. NOT_FOUND: the database has no such asset. DATA_LOSS: the stored
// bytes do not match the hash; the message describes the asset and how to replace it.
[[nodiscard]] absl::StatusOr<std::string> read_asset(Database& database, const std::string& sha256);
// Like read_asset(), without the bytes.
[[nodiscard]] absl::Status check_asset(Database& database, const std::string& sha256);

// Checks the output of a heat job. NOT_FOUND: the job has no output.
[[nodiscard]] absl::Status check_heat_output(Database& database, std::int64_t job_id);
// Checks each SHA-256 that a statement without parameters lists. Returns the error of the first
// asset that is damaged or missing.
[[nodiscard]] absl::Status check_assets(Database& database, const char* listed);

// Stores an asset whose bytes match its hash. An existing asset stays, unless it is damaged; then
// it is replaced.
[[nodiscard]] absl::Status store_asset(Database& database, const Asset& asset);
[[nodiscard]] absl::Status store_asset(Database& database, const std::string& sha256,
                                       std::string_view bytes);

// Returns a description of an asset, with the remedy if it is damaged: "SHA256 (temperatures
// computed for the season "winter" of the sweep "ship")".
[[nodiscard]] absl::StatusOr<std::string> describe_asset(Database& database,
                                                         const std::string& sha256);
[[nodiscard]] std::string how_to_replace_asset(const std::string& database_path);

// Reopens finished heat jobs whose output is damaged, and makes the jobs that need their output
// wait for them. Returns the number of reopened heat jobs.
[[nodiscard]] absl::StatusOr<std::uint64_t> reopen_damaged_heat_jobs(Database& database);

}  // namespace irsig
