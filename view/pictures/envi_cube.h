#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/image/image.h"

namespace irsig {

// One band of an ENVI cube: the image of one row.
struct EnviBand {
  std::string name;
  double lambda_min_um = 0, lambda_max_um = 0;
};

// An ENVI cube: NAME.bsq has the bands one after the other, float32 in W/(m2 sr) without header;
// NAME.hdr is a text that describes them.
struct EnviCube {
  std::uint32_t width_px = 0, height_px = 0;
  std::vector<EnviBand> band;
  std::string description;
};

// Writes the pixels of one band to its place in the file, which is made if it is not there. Bands
// may be written in any order and by several threads. INVALID_ARGUMENT and UNAVAILABLE: the file
// cannot be written.
[[nodiscard]] absl::Status write_envi_band(const std::string& path, std::size_t band,
                                           const RadianceImage& image);

// Returns the text of the header. Wavelengths are the middles of the bands, "fwhm" their widths.
[[nodiscard]] std::string envi_header(const EnviCube& cube);

}  // namespace irsig
