#pragma once

#include <string>

#include "absl/status/status.h"
#include "schema/result.pb.h"

namespace irsig {

// The largest side of a stored picture: output.thumbnail_px ends there.
inline constexpr std::uint32_t kMostPixels = 4096;

// INVALID_ARGUMENT, naming `path`, unless both pictures are what a worker makes, of the stated
// size: a PNG of 8 bit grey whose parts are whole and whose pixels, when inflated (into a buffer of
// 16 kB), are exactly width x height; an OpenEXR file of one channel whose header states that size,
// whose blocks are all there and whose bytes are no more than its pixels would take. So whoever
// decodes them later takes what these sizes say, and no more.
[[nodiscard]] absl::Status check_thumbnail(const schema::Thumbnail& thumbnail,
                                           const std::string& path);

}  // namespace irsig
