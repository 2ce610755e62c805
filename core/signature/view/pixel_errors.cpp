#include "core/signature/view/pixel_errors.h"

#include <algorithm>
#include <cmath>

namespace irsig {
namespace {

constexpr double kRounding = 5e-7;
// Inside the target all samples of a pixel are better stratified than each of its groups. The
// scatter of two groups is 2^(1/4) too large where light changes smoothly: rms z 0.7 instead of
// 0.83 inside the frigate by day, and 0.82 instead of 0.97 in glints (ops/image_errors.py).
constexpr double kOfWhole = 0.707;

// Calls visit(neighbour) for the pixel (x, y) and its eight neighbours inside the picture.
template <typename Visit>
void for_each_near(std::uint32_t width_px, std::uint32_t height_px, std::uint32_t x,
                   std::uint32_t y, Visit visit) {
  for (std::uint32_t row = y > 0 ? y - 1 : 0; row < std::min(y + 2, height_px); ++row)
    for (std::uint32_t column = x > 0 ? x - 1 : 0; column < std::min(x + 2, width_px); ++column)
      visit(static_cast<std::size_t>(row) * width_px + column);
}

double unmet_share(std::uint32_t samples) { return std::pow(samples, -1.5); }

}  // namespace

void add_unmet(std::uint32_t width_px, std::uint32_t height_px, std::uint32_t samples,
               PixelSums& part) {
  const double unmet = unmet_share(samples);
  for (std::uint32_t y = 0; y < height_px; ++y)
    for (std::uint32_t x = 0; x < width_px; ++x) {
      const std::size_t own = static_cast<std::size_t>(y) * width_px + x;
      double difference = 0;
      for_each_near(width_px, height_px, x, y, [&](std::size_t i) {
        difference = std::max(difference, std::abs(part.w_sr[i] - part.w_sr[own]));
      });
      part.variance[own] += std::pow(unmet * difference, 2);
    }
}

PixelErrors::PixelErrors(std::uint32_t width_px, std::uint32_t height_px, std::uint32_t samples,
                         std::span<const TracedPictures::Met> met)
    : width_px_(width_px),
      height_px_(height_px),
      samples_(samples),
      filled_(static_cast<std::size_t>(width_px) * height_px, Filled::kNone) {
  std::vector<std::uint32_t> count(filled_.size(), 0);
  for (const TracedPictures::Met& m : met) count[m.pixel] += m.samples;
  for (std::size_t i = 0; i < count.size(); ++i)
    if (count[i] > 0) filled_[i] = count[i] < samples ? Filled::kInPart : Filled::kWhole;
}

std::vector<double> PixelErrors::of(const PixelSums& picture) const {
  std::vector<double> out(filled_.size());
  const double unmet = unmet_share(samples_);
  for (std::uint32_t y = 0; y < height_px_; ++y)
    for (std::uint32_t x = 0; x < width_px_; ++x) {
      const std::size_t own = static_cast<std::size_t>(y) * width_px_ + x;
      double variance = 0, alike = 0, difference = 0;
      for_each_near(width_px_, height_px_, x, y, [&](std::size_t i) {
        difference = std::max(difference, std::abs(picture.w_sr[i] - picture.w_sr[own]));
        if (filled_[i] != filled_[own]) return;
        variance += picture.variance[i];
        ++alike;
      });
      if (filled_[own] == Filled::kWhole) variance *= kOfWhole;
      out[own] = std::sqrt(variance / alike + std::pow(unmet * difference, 2) +
                           std::pow(kRounding * picture.w_sr[own], 2));
    }
  return out;
}

}  // namespace irsig
