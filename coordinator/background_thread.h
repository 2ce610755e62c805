#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "absl/functional/any_invocable.h"

namespace irsig {

// Runs long work, one piece after the other, that must block neither gRPC nor the commit loop.
// Thread-safe, except stop(), which only the thread that made the object may call.
class BackgroundThread {
 public:
  using Work = absl::AnyInvocable<void()>;

  BackgroundThread() : thread_([this] { run(); }) {}
  ~BackgroundThread() { stop(); }

  // Queues `work`. Returns false if the thread has stopped: `work` will not run.
  [[nodiscard]] bool post(Work work) {
    {
      const std::lock_guard lock(mutex_);
      if (stopping_) return false;
      waiting_.push_back(std::move(work));
    }
    changed_.notify_one();
    return true;
  }

  // Stops the thread after all posted work has run.
  void stop() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    changed_.notify_one();
    if (thread_.joinable()) thread_.join();
  }

 private:
  void run() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
      if (waiting_.empty()) return;
      Work work = std::move(waiting_.front());
      waiting_.pop_front();
      lock.unlock();
      work();
      lock.lock();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Work> waiting_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace irsig
