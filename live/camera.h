#pragma once

#include <cstdint>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/geo/frames.h"
#include "core/geo/viewpoint.h"
#include "core/signature/view/image_spec.h"

namespace irsig {

// Limits of a live camera; they bound the cost of a frame.
inline constexpr std::uint32_t kLeastLivePixels = 16, kMostLiveSide = 1280;
inline constexpr std::uint32_t kMostLivePixels = 640 * 512;

// A camera of the live view: its position as seen from the target, and the point in the middle of
// its picture. It is the camera of a sweep file: [viewpoints] and [image].
struct LiveCamera {
  double azimuth_deg = 0, elevation_deg = 10;  // aspects of the sensor, at the target
  double range_m = 1000;
  double field_of_view_deg = 2;  // of the picture's width
  Vec<Body> look_at_m;           // in the middle of the picture, body frame
  std::uint32_t width_px = 320, height_px = 256;

  [[nodiscard]] Viewpoint viewpoint() const { return {azimuth_deg, elevation_deg, range_m}; }
  // Returns the angle [rad] of a pixel in the middle of the picture.
  [[nodiscard]] double pixel_rad() const;
  // Returns the image specification: layer "at_sensor", without an accuracy.
  [[nodiscard]] ImageSpec image() const;
  bool operator==(const LiveCamera&) const = default;
};

// Returns INVALID_ARGUMENT for a number that is not finite or beyond its limits; the message names
// the parameter, its value and the limits.
[[nodiscard]] absl::Status check_camera(const LiveCamera& camera);

// Returns the point in the middle of the picture as a sweep file states it, nearer to the target's
// reference point than the sensor: look_at_m, or the nearest such point on the same line of sight.
// INVALID_ARGUMENT: the camera looks away from the target.
[[nodiscard]] absl::StatusOr<Vec<Body>> look_at_of_sweep(const LiveCamera& camera);

}  // namespace irsig
