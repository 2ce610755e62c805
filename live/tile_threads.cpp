#include "live/tile_threads.h"

namespace irsig {

TileThreads::TileThreads(std::uint32_t threads) {
  for (std::uint32_t t = 1; t < threads; ++t)
    thread_.emplace_back([this, t] {
      std::uint64_t seen = 0;
      for (;;) {
        {
          std::unique_lock lock(mutex_);
          begins_.wait(lock, [&] { return stopped_ || round_ != seen; });
          if (stopped_) return;
          seen = round_;
        }
        take_tiles(t);
        const std::lock_guard lock(mutex_);
        if (--at_work_ == 0) ends_.notify_one();
      }
    });
}

TileThreads::~TileThreads() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  begins_.notify_all();
  for (std::thread& t : thread_) t.join();
}

void TileThreads::take_tiles(std::uint32_t thread) {
  for (;;) {
    const std::uint32_t tile = next_.fetch_add(1, std::memory_order_relaxed);
    if (tile >= tiles_) return;
    (*work_)(tile, thread);
  }
}

void TileThreads::run(std::uint32_t tiles, const Work& work) {
  {
    const std::lock_guard lock(mutex_);
    work_ = &work;
    tiles_ = tiles;
    next_ = 0;
    at_work_ = static_cast<std::uint32_t>(thread_.size());
    ++round_;
  }
  begins_.notify_all();
  take_tiles(0);
  std::unique_lock lock(mutex_);
  ends_.wait(lock, [&] { return at_work_ == 0; });
}

}  // namespace irsig
