#include "schema/image_size.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/accuracy/image_layers.h"

namespace irsig {
namespace {

// 0 where a pilot makes no images.
double pixels_of(const schema::Sweep& sweep) {
  if (sweep.output().has_thumbnail_px() && sweep.output().thumbnail_px() == 0) return 0;
  const schema::Image& image = sweep.image();
  return image.pixels_size() == 2 ? static_cast<double>(image.pixels(0)) * image.pixels(1) : 0;
}

}  // namespace

double image_bytes_of_row(const schema::Sweep& sweep) {
  // Radiances are float32, packed if that makes them less; standard errors take a quarter. And a
  // grey picture to look at.
  constexpr double kBytesOfLayer = 4, kBytesOfError = 1, kBytesOfGrey = 1;
  const auto& layers = sweep.image().layers();
  const auto errors = 1 + std::count_if(layers.begin(), layers.end(), [](const std::string& name) {
                        const auto layer = image_layer_of(name);
                        return layer && has_standard_error(*layer);
                      });
  // Whole parts take two entries of 6 bytes a pixel, packed.
  const double whole_parts = sweep.image().whole_parts() ? 4 : 0;
  return pixels_of(sweep) *
         (kBytesOfLayer * (1 + layers.size()) + kBytesOfError * static_cast<double>(errors) +
          kBytesOfGrey + whole_parts);
}

double image_memory_of_row(const schema::Sweep& sweep) {
  // At the target and at the sensor: sums, errors, and those of six kinds of light; then the
  // pixels and their errors as numbers, twice for a moment.
  constexpr double kBytesOfTracing = 2 * (8 + 4 + 6 * (4 + 4)), kBytesOfLayer = 8;
  return pixels_of(sweep) * (kBytesOfTracing + kBytesOfLayer * (2 + sweep.image().layers_size())) +
         image_bytes_of_row(sweep);
}

double most_rows_with_images(const schema::Sweep& sweep) {
  const double bytes = image_bytes_of_row(sweep);
  return bytes > 0 ? std::max(1.0, std::floor(kMostImageBytes / bytes)) : HUGE_VAL;
}

}  // namespace irsig
