#pragma once

#include <cstddef>
#include <vector>

#include "live/frame.h"

namespace irsig {

// Errors of a picture's pixels relative to their radiance, as standard errors. Only pixels in which
// rays met the target count (LiveFrame::met).
struct PictureErrors {
  double rms = 0, percentile_99 = 0;
};
[[nodiscard]] PictureErrors errors_of(const LiveFrame& frame);

// Independent estimates of one picture, joined with weights in proportion to their rays.
class JoinedFrames {
 public:
  // Errors as LiveFrame states them. The first frame decides the size.
  void add(const LiveFrame& frame, double rays);
  // Returns the weighted mean with its errors. Needs a frame.
  [[nodiscard]] LiveFrame mean() const;

 private:
  LiveFrame first_;
  double rays_ = 0;
  std::vector<double> sum_, squares_;  // of rays x radiance and of (rays x error)^2
};

}  // namespace irsig
