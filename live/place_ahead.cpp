#include "live/place_ahead.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace irsig {
namespace {

// Places ahead for which nodes are made, in frames.
constexpr double kFramesAhead[] = {0, 8, 20, 40, 70};

Viewpoint ahead_of(const Viewpoint& v, const Viewpoint& step, double frames) {
  const double azimuth = std::fmod(v.aspect_azimuth_deg + frames * step.aspect_azimuth_deg, 360.0);
  return {azimuth < 0 ? azimuth + 360 : azimuth,
          std::clamp(v.aspect_elevation_deg + frames * step.aspect_elevation_deg, -89.0, 89.0),
          std::max(1.0, v.range_m + frames * step.range_m)};
}

}  // namespace

PlaceAhead::PlaceAhead(PlaceGrid& grid) : grid_(grid), thread_([this] { work(); }) {}

PlaceAhead::~PlaceAhead() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void PlaceAhead::moved(const Viewpoint& v) {
  const std::lock_guard lock(mutex_);
  if (last_) {
    const double turn = std::remainder(v.aspect_azimuth_deg - last_->aspect_azimuth_deg, 360.0);
    step_ = {turn, v.aspect_elevation_deg - last_->aspect_elevation_deg,
             v.range_m - last_->range_m};
  }
  last_ = v;
  fresh_ = true;
  wake_.notify_all();
}

void PlaceAhead::work() {
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 5);  // frames come first
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [&] { return stopped_ || fresh_; });
    if (stopped_) return;
    fresh_ = false;
    const Viewpoint from = *last_, step = step_;
    for (const double frames : kFramesAhead) {
      bool made = true;
      while (made && !stopped_ && !fresh_) {
        lock.unlock();
        made = grid_.make_one(ahead_of(from, step, frames));
        lock.lock();
      }
    }
  }
}

}  // namespace irsig
