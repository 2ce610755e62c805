#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "schema/result.pb.h"

namespace irsig {

// Samples of a pixel that a silhouette may state: counts are of 16 bits.
inline constexpr std::uint32_t kMostPixelSamples = 65535;

// The largest side of a stored picture: output.thumbnail_px ends there.
inline constexpr std::uint32_t kMostPixels = 4096;

// Checks that all pictures have the stated size and the format that a worker writes. A PNG has 8
// bit grey pixels and complete chunks, and its inflated pixels are exactly width x height; the
// check inflates them into a buffer of 16 kB. An OpenEXR file has one channel, a header with that
// size, all blocks, and no more bytes than its pixels would take. Decoding therefore needs no more
// memory than the stated sizes imply. INVALID_ARGUMENT otherwise; the message names `path`.
[[nodiscard]] absl::Status check_thumbnail(const schema::Thumbnail& thumbnail,
                                           const std::string& path);

// Returns the defect of an OpenEXR file of that size, as above; empty: none. Its pixels are not
// decoded.
[[nodiscard]] std::string exr_defect(std::string_view exr, std::uint32_t width_px,
                                     std::uint32_t height_px);

// Checks a layer of an image of that size in the same way; its name is one of kImageLayers.
[[nodiscard]] absl::Status check_image_layer(const schema::ImageLayer& layer,
                                             std::uint32_t width_px, std::uint32_t height_px,
                                             const std::string& path);

// Calls visit(index of the part, pixel, count) for each pixel that shows a part, one part after the
// other. Needs no more memory than the frame's and one box's. DATA_LOSS as soon as the data cannot
// be a worker's:
//   - a frame of another size than images have, a part twice, or a box that is not in the frame
//   - damaged counts, only zero counts, or a pixel with more counts than samples
//   - boxes of more than 16 frames and 2^26 pixels together
//   - more numbers than 4 for each pixel and 2^22
[[nodiscard]] absl::Status visit_silhouette(
    const schema::Silhouette& silhouette,
    const std::function<void(int part, std::uint32_t pixel, std::uint16_t count)>& visit);

// Visits the pixels of the sets of parts in the same way: visit(index of the set, pixel, count).
// The indices in a set's part_index are not checked.
[[nodiscard]] absl::Status visit_part_sets(
    const schema::Silhouette& silhouette,
    const std::function<void(int set, std::uint32_t pixel, std::uint16_t count)>& visit);

// Checks that visit_silhouette() and visit_part_sets() reach the end of the silhouette's data.
// INVALID_ARGUMENT otherwise; the message names `path`.
[[nodiscard]] absl::Status check_silhouette(const schema::Silhouette& silhouette,
                                            const std::string& path);

}  // namespace irsig
