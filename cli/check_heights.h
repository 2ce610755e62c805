#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "cli/output_options.h"

namespace irsig {

// Returns true for the name of a map of heights: .hgt, .asc, .tif or .tiff.
[[nodiscard]] bool is_heights_file(const std::string& file);

// Writes the findings of check_heights() about a map. Returns the exit code: 2 if heights are
// missing or beyond all land.
[[nodiscard]] absl::StatusOr<int> check_heights_file(const std::string& file,
                                                     const OutputOptions& output);

}  // namespace irsig
