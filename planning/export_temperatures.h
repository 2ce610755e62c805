#pragma once

#include <ostream>
#include <string>

#include "absl/status/status.h"

namespace irsig {

// CSV: the temperatures of each facet under each condition that a stored sweep was computed with,
// stated, computed or from a file, and their errors: what a [[temperature_field]] with unit = "K"
// reads; where the sweep asks for the error of the heat model, that too (temperature_model_error_k,
// which a [[temperature_field]] does not read). An empty season, time: all. NOT_FOUND: no condition
// matches. FAILED_PRECONDITION: they have yet to be computed.
[[nodiscard]] absl::Status export_temperatures(const std::string& database,
                                               const std::string& sweep, const std::string& season,
                                               const std::string& time, std::ostream& out);

}  // namespace irsig
