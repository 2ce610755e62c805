#pragma once

#include <ostream>
#include <string>

#include "absl/status/status.h"
#include "schema/store/tables/name_set.h"

namespace irsig {

// Writes a CSV of the temperatures of each facet under each condition that a stored sweep was
// computed with, and of their errors; temperatures may be stated, computed or from a file. A
// [[temperature_field]] with unit = "K" reads this format. If the sweep requests the error of the
// heat model, the column temperature_model_error_k is added, which a [[temperature_field]] does not
// read. An empty set of seasons or an empty time selects all. NOT_FOUND: no condition matches.
// FAILED_PRECONDITION: the temperatures have not been computed yet.
[[nodiscard]] absl::Status export_temperatures(const std::string& database,
                                               const std::string& sweep, const NameSet& season,
                                               const std::string& time, std::ostream& out);

}  // namespace irsig
