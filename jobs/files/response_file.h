#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/spectral/band.h"

namespace irsig {

// Reads a spectral response from a CSV file with the columns wavelength_um and `value`. The
// response is linear between its points and 0 outside them, so that it is 0 at both ends or cut off
// there. INVALID_ARGUMENT, each file:line:column: the file or a column is missing, wavelengths do
// not increase, a value is negative, there are fewer than two points, or the response is 0
// everywhere.
[[nodiscard]] absl::StatusOr<std::vector<SpectralPoint>> read_response(
    const std::string& path, const std::string& value = "response");

}  // namespace irsig
