#include "core/signature/view/picture_window.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace irsig {
namespace {

// Along the side of a pixel: a target of 1e-9 of its area is met.
constexpr std::uint32_t kMostSquares = 65536;
// Counts of a pixel's samples that are stored have 16 bits.
constexpr std::uint32_t kMostCounted = 32768;

struct Range {
  std::uint32_t first = 0, count = 0;
};

// Squares that overlap a length, counted from `origin_m`.
Range overlapping(double from_m, double length_m, double origin_m, double square_m,
                  std::uint32_t squares) {
  const double most = squares;
  const double first = std::clamp(std::floor((from_m - origin_m) / square_m), 0.0, most),
               last = std::clamp(std::ceil((from_m + length_m - origin_m) / square_m), 0.0, most);
  return {static_cast<std::uint32_t>(first),
          last > first ? static_cast<std::uint32_t>(last - first) : 0};
}

}  // namespace

PictureWindow::PictureWindow(const PlaneRectangle& target, const PictureFrame& frame,
                             std::uint32_t samples)
    : frame_width_(frame.width_px), traced_(frame) {
  const PlaneRectangle& r = frame.rectangle;
  const double pixel_m = r.width_m / frame.width_px;
  for (;; side_ *= 2) {
    const double square_m = pixel_m / side_;
    const Range across =
        overlapping(target.x0_m, target.width_m, r.x0_m, square_m, frame.width_px * side_);
    const Range up =
        overlapping(target.y0_m, target.height_m, r.y0_m, square_m, frame.height_px * side_);
    traced_.width_px = across.count;
    traced_.height_px = up.count;
    if (across.count == 0 || up.count == 0) {
      traced_.width_px = traced_.height_px = 0;
      return;
    }
    const std::uint64_t rays =
        std::uint64_t{across.count} * up.count * (samples > 0 ? samples : kPixelSamples);
    if (rays < kLeastPictureSamples && side_ < kMostSquares) continue;
    fine_left_ = across.first;
    fine_top_ = frame.height_px * side_ - up.first - up.count;
    traced_.rectangle = {r.x0_m + across.first * square_m, r.y0_m + up.first * square_m,
                         across.count * square_m, up.count * square_m};
    left_ = fine_left_ / side_;
    top_ = fine_top_ / side_;
    width_ = (fine_left_ + across.count - 1) / side_ - left_ + 1;
    height_ = (fine_top_ + up.count - 1) / side_ - top_ + 1;
    return;
  }
}

TracedPictures PictureWindow::joined(TracedPictures squares, const ImagePlan& plan,
                                     std::uint32_t& samples) const {
  if (side_ == 1) return squares;
  TracedPictures out;
  const std::size_t images = plan.images, kinds = images * plan.kinds,
                    values = plan.first_numbers();
  std::vector<double> variance(pixels() * images, 0.0),
      kind(squares.kind_sum.empty() ? 0 : pixels() * kinds, 0.0), kind_variance = kind;
  out.sum.assign(pixels() * images, 0.0);
  out.first_sum.assign(squares.first_sum.empty() ? 0 : pixels() * values, 0.0);
  const auto pixel_of_square = [&](std::size_t square) {
    const std::size_t row = (fine_top_ + square / plan.width_px) / side_ - top_,
                      column = (fine_left_ + square % plan.width_px) / side_ - left_;
    return row * width_ + column;
  };
  for (std::size_t s = 0; s < plan.pixels(); ++s) {
    const std::size_t pixel = pixel_of_square(s);
    for (std::size_t k = 0; k < images; ++k) {
      out.sum[pixel * images + k] += squares.sum[s * images + k];
      variance[pixel * images + k] +=
          std::pow(static_cast<double>(squares.stderr_[s * images + k]), 2);
    }
    for (std::size_t k = 0; !kind.empty() && k < kinds; ++k) {
      kind[pixel * kinds + k] += static_cast<double>(squares.kind_sum[s * kinds + k]);
      kind_variance[pixel * kinds + k] +=
          std::pow(static_cast<double>(squares.kind_stderr[s * kinds + k]), 2);
    }
    for (std::size_t k = 0; !out.first_sum.empty() && k < values; ++k)
      out.first_sum[pixel * values + k] += squares.first_sum[s * values + k];
  }
  for (const double v : variance) out.stderr_.push_back(static_cast<float>(std::sqrt(v)));
  for (const double v : kind) out.kind_sum.push_back(static_cast<float>(v));
  for (const double v : kind_variance) out.kind_stderr.push_back(static_cast<float>(std::sqrt(v)));
  using OfPixels = std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint64_t>;
  const auto of_pixels = [&](const std::vector<TracedPictures::Met>& of_squares) {
    OfPixels all;
    for (const TracedPictures::Met& m : of_squares)
      all[{static_cast<std::uint32_t>(pixel_of_square(m.pixel)), m.part}] += m.samples;
    return all;
  };
  const std::uint64_t of_pixel = std::uint64_t{samples} * side_ * side_;
  samples = static_cast<std::uint32_t>(std::min<std::uint64_t>(of_pixel, kMostCounted));
  struct Pixel {
    std::uint32_t rest;
    double met = 0;
  };
  const auto counted = [&](const OfPixels& met, std::map<std::uint32_t, Pixel>& seen) {
    std::vector<TracedPictures::Met> all;
    for (const auto& [place, count] : met) {
      // Rounded down, so that no pixel has more than there are; but a part that is seen is kept.
      Pixel& pixel = seen.try_emplace(place.first, Pixel{samples}).first->second;
      pixel.met += static_cast<double>(count);
      const auto rays = std::min(
          pixel.rest,
          std::max<std::uint32_t>(1, static_cast<std::uint32_t>(count * samples / of_pixel)));
      if (rays == 0) continue;
      pixel.rest -= rays;
      all.push_back({place.first, place.second, rays});
    }
    return all;
  };
  std::map<std::uint32_t, Pixel> seen, of_sets;
  out.met = counted(of_pixels(squares.met), seen);
  out.met_set = counted(of_pixels(squares.met_set), of_sets);
  out.part_set = std::move(squares.part_set);
  // Sums over first hits are of as many samples as are counted.
  for (const auto& [pixel, of] : seen)
    for (std::size_t k = 0; !out.first_sum.empty() && k < values; ++k)
      out.first_sum[pixel * values + k] *= (samples - of.rest) / of.met;
  return out;
}

}  // namespace irsig
