#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// In-band radiance, row by row from the top left.
struct RadianceImage {
  std::uint32_t width_px = 0, height_px = 0;
  std::vector<float> radiance_w_m2_sr;
};

// Encodes for machines: OpenEXR, one float32 channel "Y", the pixels as they are. RLE compression:
// for a 128 x 64 thumbnail, 60 % of it target, 0.10 ms and 17.8 kB, against 0.05 ms and 34.1 kB
// without, 0.32 ms and 16.7 kB with ZIP, 1.9 ms and 32.1 kB with PIZ.
[[nodiscard]] absl::StatusOr<std::string> encode_exr(const RadianceImage& image);
// Encodes standard errors likewise: each is rounded up, by at most 6 %, to a number of 4 binary
// digits behind the first, and they are packed with ZIP.
[[nodiscard]] absl::StatusOr<std::string> encode_error_exr(const RadianceImage& image);

// Encodes layers of an image: OpenEXR, one float32 channel "NAME.Y" for each, packed with ZIP.
//   layers  by name, the pixels of each row by row from the top left
[[nodiscard]] absl::StatusOr<std::string> encode_layers_exr(
    std::uint32_t width_px, std::uint32_t height_px,
    const std::map<std::string, std::vector<float>>& layers);

// Linear from black to white, what is outside is black or white. [W/(m2 sr)]
struct GreyScale {
  float black_w_m2_sr, white_w_m2_sr;
};

// How a PNG is packed: kSmall tries all filters for each line; kFast has one filter and compresses
// lightly, for exports of many images.
enum class PngPacking : std::uint8_t { kSmall, kFast };

// Encodes for people: PNG, grey of 8 or 16 bits, on the scale given or else from 0 to the image's
// largest radiance; black everywhere when that is 0. 0.15 ms and 2.0 kB for the same image.
[[nodiscard]] absl::StatusOr<std::string> encode_png(const RadianceImage& image);
[[nodiscard]] absl::StatusOr<std::string> encode_png(const RadianceImage& image,
                                                     const GreyScale& scale, int bits = 8,
                                                     PngPacking packing = PngPacking::kSmall);

// Encodes numbers as a PNG of grey, row by row from the top left. INVALID_ARGUMENT as below, for
// bits other than 8 and 16, and for a number that has more of them.
[[nodiscard]] absl::StatusOr<std::string> encode_grey_png(std::uint32_t width_px,
                                                          std::uint32_t height_px,
                                                          std::span<const std::uint16_t> values,
                                                          int bits,
                                                          PngPacking packing = PngPacking::kSmall);

// Both: equal pixels give equal bytes, whenever and wherever they are written: no host or program
// names, and the date of an EXR file is always 1970-01-01. But for kFast the bytes are those of
// OpenImageIO 2.4, which takes 0.4 s of CPU time to load. INVALID_ARGUMENT for an empty image,
// pixels that do not fill it, or one that is not finite. Safe to call from several threads; no
// thread of its own.

// Light in front of and behind a target, for an image of the target alone, 0 elsewhere.
struct SeenFrom {
  double gain = 1;                         // what of the target's radiance arrives
  double path_radiance_w_m2_sr = 0;        // between target and sensor
  double background_radiance_w_m2_sr = 0;  // at the sensor, beside the target
  std::vector<float> filled;               // [pixel] the fraction of it that is target
};

// Returns the image at the sensor:
//   filled x (path radiance) + gain x radiance + (1 - filled) x background
// INVALID_ARGUMENT: the fractions are not one for each pixel.
[[nodiscard]] absl::StatusOr<RadianceImage> seen_from(const RadianceImage& image,
                                                      const SeenFrom& there);

// The part of an image that is not black, and its largest radiance.
struct ImageContent {
  float hottest_w_m2_sr = 0;
  std::uint32_t shown_px = 0;                                          // pixels that are not 0
  std::uint32_t left_px = 0, top_px = 0, width_px = 0, height_px = 0;  // their box; 0: none
};
[[nodiscard]] ImageContent content_of(const RadianceImage& image);

}  // namespace irsig
