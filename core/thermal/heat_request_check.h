#pragma once

#include <string>

#include "absl/status/status.h"
#include "core/thermal/heat_request.h"

namespace irsig {

// Returns the first error of a request, before solve_heat computes anything. Private to
// core/thermal.
[[nodiscard]] absl::Status check_request(const HeatRequest& request);

// Returns INVALID_ARGUMENT "name = value, expected ...".
[[nodiscard]] absl::Status wrong_number(const std::string& name, double value,
                                        const std::string& expected);

}  // namespace irsig
