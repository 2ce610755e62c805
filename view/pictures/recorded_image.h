#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "core/image/image.h"
#include "core/imager/imager.h"
#include "schema/store/tables/rows.h"

namespace irsig {

// The counts of a stored image, and the radiance of each of the detector's pixels without noise.
struct RecordedCounts {
  DetectorGrid grid;
  RadianceImage noiseless;
  CountsImage counts;
};
// Returns the detector's pixels of an image; arguments and errors as those of record_image().
[[nodiscard]] absl::StatusOr<DetectorGrid> recorded_grid(const Imager& imager,
                                                         std::uint32_t width_px,
                                                         std::uint32_t height_px, double pixel_rad,
                                                         bool with_surroundings);
// Records an image of radiance at the sensor, with the arguments and errors of record_image().
[[nodiscard]] absl::StatusOr<RecordedCounts> record_counts(
    const Imager& imager, const ImagerInBand& figures, const StoredSignature& row,
    const RadianceImage& seen, double pixel_rad, bool with_surroundings);

// A stored image as an imager records it.
struct RecordedImage {
  ImagerInBand figures;
  std::string png;            // counts: grey of 8 bits, or of 16 for 14 and 16 bits
  std::string noiseless_exr;  // radiance of each pixel without noise, fixed pattern and saturation
  std::uint64_t saturated_px = 0;
  StoredSilhouette silhouette;  // mean fractions of the imager's pixels
};
// Records an image of radiance at the sensor. The noise depends on sweep, season, time, band,
// aspect and range of `row`, so that a slice of the database gives the same counts.
//   with_surroundings  the image shows sky, horizon and sea up to its border; beyond the border its
//                      outermost pixels are repeated, and no margin is added. If false, the row's
//                      background is used
// INVALID_ARGUMENT: the stored pixels are too coarse for the imager, or the image would be too
// large.
[[nodiscard]] absl::StatusOr<RecordedImage> record_image(
    const Imager& imager, const ImagerInBand& figures, const StoredSignature& row,
    const RadianceImage& seen, double pixel_rad, const StoredSilhouette& silhouette,
    bool with_surroundings = false);

// Returns the parts on the pixels of a detector: the mean fraction of the stored pixels under each,
// weighted with the areas that they share.
[[nodiscard]] StoredSilhouette on_detector(const StoredSilhouette& silhouette,
                                           const DetectorGrid& grid);

}  // namespace irsig
