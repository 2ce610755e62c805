#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/spectral/band.h"

namespace irsig {

// A spectral response from a CSV file with the columns wavelength_um and `value`: linear between
// its points, 0 outside them, and so 0 at both ends or cut off there. INVALID_ARGUMENT, each
// file:line:column: no such file or column, wavelengths that do not increase, a negative value,
// fewer than two points, 0 everywhere.
[[nodiscard]] absl::StatusOr<std::vector<SpectralPoint>> read_response(
    const std::string& path, const std::string& value = "response");

}  // namespace irsig
