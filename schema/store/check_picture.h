#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "schema/result.pb.h"

namespace irsig {

// Samples of a pixel that a silhouette may state: counts are of 16 bits.
inline constexpr std::uint32_t kMostPixelSamples = 65535;

// The largest side of a stored picture: output.thumbnail_px ends there.
inline constexpr std::uint32_t kMostPixels = 4096;

// INVALID_ARGUMENT, naming `path`, unless all pictures are what a worker makes, of the stated
// size: a PNG of 8 bit grey whose parts are whole and whose pixels, when inflated (into a buffer of
// 16 kB), are exactly width x height; OpenEXR files of one channel whose headers state that size,
// whose blocks are all there and whose bytes are no more than their pixels would take. So whoever
// decodes them later takes what these sizes say, and no more.
[[nodiscard]] absl::Status check_thumbnail(const schema::Thumbnail& thumbnail,
                                           const std::string& path);

// INVALID_ARGUMENT, naming `path`, unless the boxes of all parts lie in the picture, hold one count
// for each of their pixels, none above the samples of a pixel, and a pixel's counts together are no
// more than those. Which parts these are is not looked at.
[[nodiscard]] absl::Status check_silhouette(const schema::Silhouette& silhouette,
                                            const std::string& path);

// The counts of one part: schema::PartPixels of a silhouette, which may have no parts here.
// DATA_LOSS: they are damaged.
[[nodiscard]] absl::StatusOr<std::vector<std::uint16_t>> unpacked_samples(
    const schema::Silhouette& silhouette, const schema::PartPixels& part);

}  // namespace irsig
