#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/image/image.h"
#include "view/pictures/thumbnail.h"
#include "view/query/query.h"

namespace irsig {

// The image of a row as stored.
struct RowImage {
  StoredSignature signature;
  schema::Thumbnail thumbnail;
  StoredSilhouette silhouette;
  std::vector<schema::ImageLayer> layers;

  // Returns a layer of a name; null if there is no such layer among `layers`.
  [[nodiscard]] const schema::ImageLayer* layer(std::string_view name) const;
};

// Which radiance of a stored image a picture shows.
struct ShownAsked {
  std::string layer;        // of this further image; empty: the radiance at the target
  bool background = false;  // as at the sensor, before the row's background

  // Returns the layer that is shown if the image has it; empty: none.
  [[nodiscard]] std::string wanted_layer() const;
};

struct ShownImage {
  std::string_view exr;  // of the stored image, which outlives it
  std::uint32_t most_px = 0;
  std::optional<SeenFrom> seen = std::nullopt;  // conditions at the sensor; none: as it is stored
};

// Returns the radiance that a picture shows.
//   most_px  the longest side that an image of the row may have
// NOT_FOUND: the image has no such layer. FAILED_PRECONDITION and INVALID_ARGUMENT: the row cannot
// be put before a background.
[[nodiscard]] absl::StatusOr<ShownImage> shown_image(const RowImage& image, const ShownAsked& asked,
                                                     std::uint32_t most_px);

// Calls visit(i, its radiances) once for each image, on all cores and in no order. An image that
// cannot be read is visited with INVALID_ARGUMENT, which states why. Files with the layout of irsig
// are decoded by this process, all others by `read`. The first failure in the order of i.
[[nodiscard]] absl::Status visit_images(
    std::span<const ShownImage> images, const ReadPictures& read,
    const std::function<absl::Status(std::size_t, absl::StatusOr<RadianceImage>)>& visit);

}  // namespace irsig
