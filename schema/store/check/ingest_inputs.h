#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "schema/job.pb.h"
#include "schema/result.pb.h"
#include "schema/store/tables/database.h"

namespace irsig {

// Returns the names of a sweep's uncertain inputs, in the order of the grammar. Empty: the sweep
// states no uncertain inputs.
[[nodiscard]] std::vector<std::string> input_names(const schema::ResolvedSweep& sweep);

// Checks that a row has the contribution of each of these inputs, in their order, and the total;
// without inputs the row must have neither. INVALID_ARGUMENT otherwise; the message names the
// field.
[[nodiscard]] absl::Status check_inputs(const schema::SignatureRow& row,
                                        const std::vector<std::string>& names,
                                        const std::string& path);

// Inserts the inputs of a row that was checked.
[[nodiscard]] absl::Status insert_inputs(Database& database, std::int64_t signature_id,
                                         const schema::SignatureRow& row);

}  // namespace irsig
