#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "schema/job.pb.h"
#include "schema/result.pb.h"
#include "schema/store/tables/database.h"

namespace irsig {

// The names of a sweep's uncertain inputs, in the order of the grammar. Empty: it states none.
[[nodiscard]] std::vector<std::string> input_names(const schema::ResolvedSweep& sweep);

// INVALID_ARGUMENT, naming the field, unless a row has what each of these inputs contributes, in
// their order, and what they come to; or nothing of it where there are none.
[[nodiscard]] absl::Status check_inputs(const schema::SignatureRow& row,
                                        const std::vector<std::string>& names,
                                        const std::string& path);

// Inserts the inputs of a row that was checked.
[[nodiscard]] absl::Status insert_inputs(Database& database, std::int64_t signature_id,
                                         const schema::SignatureRow& row);

}  // namespace irsig
