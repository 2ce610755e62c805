#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/accuracy/image_layers.h"
#include "core/geo/frames.h"

namespace irsig {

// Images of a view with a frame, an accuracy and layers of their own.
struct ImageSpec {
  std::uint32_t width_px = 0, height_px = 0;
  // A camera states what the width subtends, and the point in the middle (body frame; absent: where
  // the view looks). Absent: the frame is the smallest that holds the target and `margin`, a
  // fraction of the target's size on each side.
  struct Camera {
    double field_of_view_rad = 0;
    std::optional<Vec<Body>> look_at_m;
  };
  std::optional<Camera> camera;
  double margin = 0;
  // Rays of each pixel, a power of two, and more where few pixels may show the target. 0: 8; with
  // an error asked for, these are the first that are tried.
  std::uint32_t samples = 0;
  // Root mean square, over the pixels that the target fills, of the standard error: relative to
  // the pixel's radiance, or in kelvin at the image's mean radiance. 0: not asked for. Rays are
  // doubled until all images of the view are as good, but not above most_samples.
  double relative_error = 0, error_k = 0;
  std::uint32_t most_samples = 4096;
  std::vector<ImageLayer> layer;  // in increasing order
  bool whole_parts = false;       // whether rays go on to what other parts hide

  [[nodiscard]] bool has(ImageLayer which) const {
    return std::find(layer.begin(), layer.end(), which) != layer.end();
  }
  [[nodiscard]] bool asks_for_error() const { return relative_error > 0 || error_k > 0; }
};

}  // namespace irsig
