#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "schema/result.pb.h"
#include "schema/store/check/ingest_ledger.h"

namespace irsig {

// The job's properties that a result must match.
struct ExpectedResult {
  std::string job_key;
  std::vector<std::uint32_t> condition_index;
  std::vector<std::uint32_t> band_index;
  std::size_t parts;
  std::size_t profile_rows;               // of each condition and band
  std::optional<bool> thumbnail;          // true: images were requested
  std::vector<std::string> image_layers;  // of each row with an image, in this order
  LedgerNames ledger;
  std::vector<std::string> inputs;  // uncertain ones, of each row
};

// Checks that a result belongs to its view. Every condition and band occurs exactly once; every
// part, effect and row of a profile occurs once. Arrays have equal lengths, wavelengths increase,
// numbers are finite, and errors and areas are not negative. INVALID_ARGUMENT otherwise; the
// message names the field.
[[nodiscard]] absl::Status check_result(const schema::JobResult& result,
                                        const ExpectedResult& expected);

// Checks results of every kind: the key is the leased job's; the seed is one; numbers are finite,
// errors and areas not negative, and counts fit into a signed column.
[[nodiscard]] absl::Status check_job_key(const schema::JobResult& result,
                                         const std::string& job_key);
// Checks that the seed has sixteen hexadecimal digits; the seed of a view depends on
// its geometry, which only the worker computes.
[[nodiscard]] absl::Status check_seed(const schema::JobResult& result);
[[nodiscard]] absl::Status check_every_number(const schema::JobResult& result);

}  // namespace irsig
