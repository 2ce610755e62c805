#pragma once

#include <cstdint>

#include "absl/status/statusor.h"
#include "core/imager/imager.h"
#include "live/frame.h"

namespace irsig {

// Returns a frame as a camera records it, on the camera's pixels: the radiance that each pixel's
// counts represent, the gain, and the stated errors with the camera's noise. The camera sees the
// content of the frame; beyond the border its outermost pixels are repeated.
//   pixel_rad  angle of a pixel of `frame` in the middle of the picture
//   number     selects the temporal noise
// INVALID_ARGUMENT: a pixel of the frame is wider than half of the camera's; the message states the
// field of view that suffices.
[[nodiscard]] absl::StatusOr<LiveFrame> recorded_frame(const Imager& imager,
                                                       const ImagerInBand& figures,
                                                       const LiveFrame& frame, double pixel_rad,
                                                       std::uint64_t number);

}  // namespace irsig
