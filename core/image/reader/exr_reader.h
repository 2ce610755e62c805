#pragma once

#include <cstdint>
#include <string_view>

#include "absl/status/statusor.h"
#include "core/image/image.h"

namespace irsig {

// Returns the pixels of an EXR file written by encode_exr. INVALID_ARGUMENT: the bytes are no such
// file or are damaged, or their header states a side of more than most_px pixels; no pixel is read
// then.
[[nodiscard]] absl::StatusOr<RadianceImage> decode_exr(std::string_view bytes,
                                                       std::uint32_t most_px);

}  // namespace irsig
