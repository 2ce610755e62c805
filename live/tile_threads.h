#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace irsig {

// Threads that share the tiles of a frame. run() is for one thread at a time.
class TileThreads {
 public:
  // Starts the threads. threads: >= 1, including the caller of run().
  explicit TileThreads(std::uint32_t threads);
  ~TileThreads();
  TileThreads(const TileThreads&) = delete;
  TileThreads& operator=(const TileThreads&) = delete;

  [[nodiscard]] std::uint32_t threads() const {
    return static_cast<std::uint32_t>(thread_.size()) + 1;
  }
  // Calls work(tile, thread) for each tile, 0 <= tile < tiles, and returns when all are done.
  using Work = std::function<void(std::uint32_t tile, std::uint32_t thread)>;
  void run(std::uint32_t tiles, const Work& work);

 private:
  void take_tiles(std::uint32_t thread);

  std::mutex mutex_;
  std::condition_variable begins_, ends_;
  std::uint64_t round_ = 0;
  std::uint32_t at_work_ = 0, tiles_ = 0;
  bool stopped_ = false;
  const Work* work_ = nullptr;
  std::atomic<std::uint32_t> next_{0};
  std::vector<std::thread> thread_;
};

}  // namespace irsig
