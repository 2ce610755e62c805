#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// Joins PNGs of the same size and kind to an animated PNG that is repeated for ever.
//   still     PNG files of one image each, at least one
//   pause_ms  display time of each image
// INVALID_ARGUMENT: a text is not a PNG, or has another size.
[[nodiscard]] absl::StatusOr<std::string> animated_png(const std::vector<std::string>& still,
                                                       std::uint16_t pause_ms);

}  // namespace irsig
