#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/image/image.h"

namespace irsig {

// Returns the pixels of an EXR file with exactly the layout that encode_exr and encode_error_exr
// (core/image/image.h) write. Returns nothing for any other file, for a damaged one, and for one
// whose header states a side of more than most_px pixels: irsig-picture reads the former and states
// what is wrong with the latter.
//
// The reader takes no more memory than the pixels of the header, follows no offset of the file, and
// calls zlib alone; so it needs no process of its own (docs/explanation/security.md). An image of
// 128 x 96 pixels takes 0.04 ms, against 0.2 ms, and 0.4 s for the start, of irsig-picture.
[[nodiscard]] std::optional<RadianceImage> read_stored_exr(std::string_view exr,
                                                           std::uint32_t most_px);

}  // namespace irsig
