#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "live/place_grid.h"

namespace irsig {

// Makes the nodes of a grid that a moving sensor will need next, in a thread of its own. moved()
// may be called by any thread.
class PlaceAhead {
 public:
  // Starts computing nodes ahead. grid: must outlive this object.
  explicit PlaceAhead(PlaceGrid& grid);
  ~PlaceAhead();
  PlaceAhead(const PlaceAhead&) = delete;
  PlaceAhead& operator=(const PlaceAhead&) = delete;

  // States where the sensor is, once a frame.
  void moved(const Viewpoint& viewpoint);

 private:
  void work();

  PlaceGrid& grid_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopped_ = false, fresh_ = false;
  std::optional<Viewpoint> last_;
  Viewpoint step_{};  // of one frame
  std::thread thread_;
};

}  // namespace irsig
