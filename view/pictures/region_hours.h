#pragma once

#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/store/reader.h"
#include "view/pictures/image_regions.h"
#include "view/pictures/thumbnail.h"
#include "view/query/query.h"
#include "view/report/days.h"

namespace irsig {

// Means over one region of the image of one row.
struct RegionValue {
  HourOfDay at;
  StoredSignature row;
  std::string region;
  std::uint64_t pixels;  // of the region
  RegionMean mean;
};

// Means over regions of the stored images of one viewpoint of a sweep through the hours of its
// days.
struct RegionHours {
  std::string sweep, layer;
  std::optional<double> solar_offset_h;  // as in Hours (view/report/hours.h)
  std::vector<RegionValue> value;        // by day, band, region and hour
};

// Returns the means of a layer of light over rectangles; without rectangles, over each part of the
// target and the whole image. A query with an aspect alone selects the nearest viewpoint. Images
// are read one after the other.
//
//   layer  of kImageLayers, a radiance
//
// Errors are those of run_query. NOT_FOUND: nothing matches, or a row has no image or no such
// layer. INVALID_ARGUMENT: several viewpoints or sweeps, no day with two times, an interpolated
// query, a layer that is not a radiance, a rectangle beyond the image. DATA_LOSS: an image is
// damaged.
[[nodiscard]] absl::StatusOr<RegionHours> region_hours(
    StoreReader& reader, const Query& query, const std::vector<ImageRectangle>& rectangles,
    const std::string& layer, const ReadPictures& read);

// Draws a panel for each day and band with the radiances (+-2 standard errors), and one for each
// day with the temperatures where there are any; one curve per region. A complete SVG document.
[[nodiscard]] std::string plot_region_hours(const RegionHours& hours);

// Writes the numbers of plot_region_hours(), a line for each region of each image, in a format of
// table.h.
[[nodiscard]] absl::Status write_region_hours(const RegionHours& hours, std::string_view format,
                                              std::ostream& out);

}  // namespace irsig
