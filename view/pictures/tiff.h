#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/image/image.h"

namespace irsig {

// Encodes an image as TIFF 6.0: one channel, little-endian, not compressed, in one strip.
//
//   bits  8 or 16: grey on `scale`, the same numbers as encode_png writes; 32: the radiances as
//         float32 [W/(m2 sr)], to which `scale` does not apply
//
// The tag ImageDescription states the radiances of 0 and of the largest number, or the unit of the
// float32 numbers. Equal pixels give equal bytes. INVALID_ARGUMENT: another number of bits, an
// empty image, pixels that do not fill it, or one that is not finite.
[[nodiscard]] absl::StatusOr<std::string> encode_tiff(const RadianceImage& image,
                                                      const GreyScale& scale, int bits);

}  // namespace irsig
