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
  std::optional<bool> thumbnail;          // whether images were asked for
  std::vector<std::string> image_layers;  // of each row with an image, in this order
  LedgerNames ledger;
  std::vector<std::string> inputs;  // uncertain ones, of each row
};

// INVALID_ARGUMENT, naming the field, unless the result is its view's: every condition and band
// exactly once, every part, effect and row of a profile once, arrays of one length on increasing
// wavelengths, finite numbers, errors and areas not negative.
[[nodiscard]] absl::Status check_result(const schema::JobResult& result,
                                        const ExpectedResult& expected);

// Checks results of every kind: the key is the leased job's; the seed is one; numbers are finite,
// errors and areas not negative, and counts fit into a signed column.
[[nodiscard]] absl::Status check_job_key(const schema::JobResult& result,
                                         const std::string& job_key);
// Sixteen hexadecimal digits. That of a view is made of its geometry, which is the worker's matter.
[[nodiscard]] absl::Status check_seed(const schema::JobResult& result);
[[nodiscard]] absl::Status check_every_number(const schema::JobResult& result);

}  // namespace irsig
