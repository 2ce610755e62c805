#include "live/joined_frames.h"

#include <algorithm>
#include <cmath>

namespace irsig {
namespace {

// Stated errors hold nine pixels in ten, as so many standard errors do.
constexpr double kStatedErrors = 1.645;

}  // namespace

PictureErrors errors_of(const LiveFrame& frame) {
  std::vector<double> relative;
  double squares = 0;
  for (std::size_t i = 0; i < frame.error.size(); ++i) {
    const auto radiance = static_cast<double>(frame.radiance_w_m2_sr[i]);
    if (frame.met[i] == 0 || !(radiance > 0)) continue;
    relative.push_back(static_cast<double>(frame.error[i]) / kStatedErrors / radiance);
    squares += relative.back() * relative.back();
  }
  if (relative.empty()) return {};
  const auto at = relative.begin() +
                  static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(relative.size() - 1));
  std::nth_element(relative.begin(), at, relative.end());
  return {std::sqrt(squares / static_cast<double>(relative.size())), *at};
}

void JoinedFrames::add(const LiveFrame& frame, double rays) {
  if (rays_ == 0) {
    first_ = frame;
    sum_.assign(frame.radiance_w_m2_sr.size(), 0.0);
    squares_ = sum_;
  }
  rays_ += rays;
  for (std::size_t i = 0; i < sum_.size(); ++i) {
    first_.met[i] = std::max(first_.met[i], frame.met[i]);
    const double error = rays * static_cast<double>(frame.error[i]);
    sum_[i] += rays * static_cast<double>(frame.radiance_w_m2_sr[i]);
    squares_[i] += error * error;
  }
}

LiveFrame JoinedFrames::mean() const {
  LiveFrame out = first_;
  for (std::size_t i = 0; i < sum_.size(); ++i) {
    out.radiance_w_m2_sr[i] = static_cast<float>(sum_[i] / rays_);
    out.error[i] = static_cast<float>(std::sqrt(squares_[i]) / rays_);
  }
  return out;
}

}  // namespace irsig
