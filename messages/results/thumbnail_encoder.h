#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// Encoders of the pixels of an in-band radiance image, row by row from the top left, into the bytes
// of a PNG and of an EXR file, and of their standard errors into another EXR file. They are passed
// in because their library takes 0.2 s to load: only `irsig-worker` loads it, never `irsig`, which
// links the rest of this module.
struct ThumbnailEncoder {
  using Encode = std::function<absl::StatusOr<std::string>(
      std::uint32_t width_px, std::uint32_t height_px, const std::vector<float>& radiance_w_m2_sr)>;
  Encode png, exr, stderr_exr;
};

}  // namespace irsig
