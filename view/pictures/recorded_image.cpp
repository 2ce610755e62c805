#include "view/pictures/recorded_image.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/sobol.h"
#include "core/base/status_macros.h"
#include "view/pictures/masks.h"

namespace irsig {
namespace {

std::uint64_t frame_of(const StoredSignature& row) {
  std::uint64_t hash = 0;
  const auto add = [&](std::uint64_t value) { hash = mix64(hash ^ value); };
  for (const std::string* text : {&row.sweep, &row.season, &row.time_utc, &row.band}) {
    add(text->size());
    for (const char byte : *text) add(static_cast<unsigned char>(byte));
  }
  for (const double place : {row.aspect_azimuth_deg, row.aspect_elevation_deg, row.range_m})
    add(std::bit_cast<std::uint64_t>(place));
  return hash;
}

// The pixels of the detector under one stored pixel along one axis, and its length on each.
struct Under {
  std::size_t first;
  std::array<double, 2> length;
};
// Both are at least one stored pixel wide, so that there are no more than two.
std::vector<Under> under_pixels(std::uint32_t stored_px, std::uint32_t detector_px, double begin,
                                double ratio) {
  std::vector<Under> out;
  for (std::uint32_t i = 0; i < stored_px; ++i) {
    const double place = std::clamp(std::floor((i - begin) / ratio), 0.0, detector_px - 1.0);
    const double within = std::clamp(begin + ratio * (place + 1) - i, 0.0, 1.0);
    const bool last = place + 1 == detector_px;
    out.push_back({static_cast<std::size_t>(place), {last ? 1 : within, last ? 0 : 1 - within}});
  }
  return out;
}

// A pixel that is filled, in whole numbers that a silhouette holds.
constexpr std::uint32_t kFilled = 65535;

}  // namespace

StoredSilhouette on_detector(const StoredSilhouette& silhouette, const DetectorGrid& grid) {
  const std::vector<Under> across =
      under_pixels(silhouette.width_px, grid.width_px, grid.left, grid.ratio);
  const std::vector<Under> down =
      under_pixels(silhouette.height_px, grid.height_px, grid.top, grid.ratio);
  const double filled = silhouette.pixel_samples * grid.ratio * grid.ratio;
  const auto recorded = [&](const std::vector<StoredSilhouette::Pixel>& pixels) {
    std::vector<double> sum(std::size_t{grid.width_px} * grid.height_px, 0);
    for (const StoredSilhouette::Pixel& pixel : pixels) {
      const Under& x = across[pixel.at % silhouette.width_px];
      const Under& y = down[pixel.at / silhouette.width_px];
      for (std::size_t j = 0; j < 2; ++j)
        for (std::size_t i = 0; i < 2; ++i)
          if (x.length[i] > 0 && y.length[j] > 0)
            sum[(y.first + j) * grid.width_px + x.first + i] +=
                pixel.samples * x.length[i] * y.length[j];
    }
    std::vector<StoredSilhouette::Pixel> there;
    for (std::uint32_t at = 0; at < sum.size(); ++at) {
      const double samples = std::round(kFilled * std::min(1.0, sum[at] / filled));
      if (samples > 0) there.push_back({at, static_cast<std::uint16_t>(samples)});
    }
    return there;
  };
  StoredSilhouette out{grid.width_px, grid.height_px, kFilled, {}, {}};
  for (const StoredSilhouette::Part& part : silhouette.part)
    if (auto pixels = recorded(part.pixel); !pixels.empty())
      out.part.push_back({part.name, std::move(pixels)});
  for (const StoredSilhouette::PartSet& set : silhouette.part_set)
    out.part_set.push_back(
        {set.part, set.outside_px / (grid.ratio * grid.ratio), recorded(set.pixel)});
  return out;
}

absl::StatusOr<DetectorGrid> recorded_grid(const Imager& imager, std::uint32_t width_px,
                                           std::uint32_t height_px, double pixel_rad,
                                           bool with_surroundings) {
  Imager framed = imager;
  if (with_surroundings) framed.margin_px = 0;
  return detector_grid(framed, width_px, height_px, pixel_rad);
}

absl::StatusOr<RecordedCounts> record_counts(const Imager& imager, const ImagerInBand& figures,
                                             const StoredSignature& row, const RadianceImage& seen,
                                             double pixel_rad, bool with_surroundings) {
  ASSIGN_OR_RETURN(const auto grid, recorded_grid(imager, seen.width_px, seen.height_px, pixel_rad,
                                                  with_surroundings));
  RecordedCounts out;
  out.grid = grid;
  const auto detect = with_surroundings ? detector_image_going_on : detector_image;
  out.noiseless =
      detect(imager, figures.wavelength_um, seen, pixel_rad, row.background_radiance_w_m2_sr, grid);
  out.counts = counts_image(imager, figures, out.noiseless, frame_of(row));
  return out;
}

absl::StatusOr<RecordedImage> record_image(const Imager& imager, const ImagerInBand& figures,
                                           const StoredSignature& row, const RadianceImage& seen,
                                           double pixel_rad, const StoredSilhouette& silhouette,
                                           bool with_surroundings) {
  ASSIGN_OR_RETURN(const auto recorded,
                   record_counts(imager, figures, row, seen, pixel_rad, with_surroundings));
  const CountsImage& counts = recorded.counts;
  RecordedImage out;
  out.figures = figures;
  ASSIGN_OR_RETURN(out.png, encode_grey_png(counts.width_px, counts.height_px, counts.counts,
                                            imager.bits == 8 ? 8 : 16));
  ASSIGN_OR_RETURN(out.noiseless_exr, encode_exr(recorded.noiseless));
  out.saturated_px = counts.saturated_px;
  out.silhouette = on_detector(silhouette, recorded.grid);
  return out;
}

}  // namespace irsig
