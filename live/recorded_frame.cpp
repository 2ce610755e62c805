#include "live/recorded_frame.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

// Stated errors hold nine pixels in ten, as 1.645 standard deviations do.
constexpr double kNineInTen = 1.645;

// Means of the errors of the frame's pixels under each of the camera's, and whether most of them
// lie on edges. Errors of neighbours have one cause, so that they are not averaged away.
void state_recorded_errors(const LiveFrame& frame, const DetectorGrid& grid, double noise_w_m2_sr,
                           LiveFrame& out) {
  const auto place = [&](double begin, std::uint32_t at, std::uint32_t size) {
    const double first = begin + grid.ratio * at;
    const auto low = static_cast<std::uint32_t>(std::clamp(std::floor(first), 0.0, size - 1.0));
    const auto high = static_cast<std::uint32_t>(
        std::clamp(std::ceil(first + grid.ratio), low + 1.0, static_cast<double>(size)));
    return std::pair(low, high);
  };
  for (std::uint32_t y = 0; y < out.height_px; ++y) {
    const auto [y0, y1] = place(grid.top, y, frame.height_px);
    for (std::uint32_t x = 0; x < out.width_px; ++x) {
      const auto [x0, x1] = place(grid.left, x, frame.width_px);
      double error = 0, edges = 0, count = 0;
      for (std::uint32_t j = y0; j < y1; ++j)
        for (std::uint32_t i = x0; i < x1; ++i) {
          const std::size_t at = std::size_t{j} * frame.width_px + i;
          error += static_cast<double>(frame.error[at]);
          edges += frame.edge[at];
          ++count;
        }
      out.error.push_back(
          static_cast<float>(std::hypot(error / count, kNineInTen * noise_w_m2_sr)));
      out.edge.push_back(edges > 0.5 * count ? 1 : 0);
    }
  }
}

double mean_of_border(const RadianceImage& image) {
  double sum = 0;
  for (std::uint32_t x = 0; x < image.width_px; ++x)
    sum += static_cast<double>(image.radiance_w_m2_sr[x]) +
           static_cast<double>(
               image.radiance_w_m2_sr[image.radiance_w_m2_sr.size() - image.width_px + x]);
  return sum / (2.0 * image.width_px);
}

}  // namespace

absl::StatusOr<LiveFrame> recorded_frame(const Imager& imager, const ImagerInBand& figures,
                                         const LiveFrame& frame, double pixel_rad,
                                         std::uint64_t number) {
  const auto begin = std::chrono::steady_clock::now();
  if (!(imager.ifov_rad() >= 2 * pixel_rad)) {
    const double most_rad = 2 * std::atan(0.25 * imager.ifov_rad() * frame.width_px);
    return absl::InvalidArgumentError(absl::StrCat(
        "the imager's pixels of ", 1e6 * imager.ifov_rad(),
        " urad are narrower than two of this picture's: expected a field of view of at most ",
        most_rad * 180 / std::numbers::pi, " deg, or more pixels"));
  }
  Imager framed = imager;
  framed.margin_px = 0;
  ASSIGN_OR_RETURN(const auto grid,
                   detector_grid(framed, frame.width_px, frame.height_px, pixel_rad));
  const RadianceImage seen{frame.width_px, frame.height_px, frame.radiance_w_m2_sr};
  const RadianceImage received = detector_image_going_on(framed, figures.wavelength_um, seen,
                                                         pixel_rad, mean_of_border(seen), grid);
  const CountsImage counts = counts_image(imager, figures, received, number);
  LiveFrame out;
  out.width_px = counts.width_px;
  out.height_px = counts.height_px;
  out.counts_per_w_m2_sr = figures.counts_per_w_m2_sr;
  out.offset_counts = figures.offset_counts;
  out.radiance_w_m2_sr.reserve(counts.counts.size());
  for (const std::uint16_t c : counts.counts)
    out.radiance_w_m2_sr.push_back(
        static_cast<float>((c - figures.offset_counts) / figures.counts_per_w_m2_sr));
  // Rounding to counts is uniform over one of them.
  const double rounding = 1 / (std::sqrt(12.0) * figures.counts_per_w_m2_sr);
  state_recorded_errors(
      frame, grid, std::hypot(figures.noise_w_m2_sr, figures.fixed_pattern_w_m2_sr, rounding), out);
  out.seconds = frame.seconds +
                std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

}  // namespace irsig
