#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <unordered_map>

namespace irsig {

// Open streams. A stream is cancelled if its client sends and receives nothing for kSilence, or if
// it is slower than kSlowest overall; a half-open call would otherwise hold its memory for ever.
// Thread-safe.
class OpenCalls {
 public:
  static constexpr auto kSilence = std::chrono::seconds(60);
  static constexpr double kSlowest_bytes_s = 16e3;

  class Call {
   public:
    virtual ~Call() = default;

   private:
    friend OpenCalls;
    virtual void cancel() = 0;  // may be called from another thread, until the call is removed
  };

  OpenCalls() : thread_([this] { watch(); }) {}
  ~OpenCalls() {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    changed_.notify_one();
    thread_.join();
  }

  void add(Call& call) {
    const std::lock_guard lock(mutex_);
    open_[&call] = {Steady::now(), Steady::now(), 0};
  }
  // Records bytes received or taken; 0 bytes count as silence.
  void moved(Call& call, std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    const auto found = open_.find(&call);
    if (found == open_.end() || bytes == 0) return;
    found->second.moved_at = Steady::now();
    found->second.bytes += bytes;
  }
  void remove(Call& call) {
    const std::lock_guard lock(mutex_);
    open_.erase(&call);
  }

 private:
  using Steady = std::chrono::steady_clock;

  struct Open {
    Steady::time_point begun, moved_at;
    std::size_t bytes = 0;
  };

  void watch() {
    std::unique_lock lock(mutex_);
    while (!changed_.wait_for(lock, kSilence / 8, [this] { return ending_; })) {
      const auto now = Steady::now();
      for (auto& [call, open] : open_) {
        const std::chrono::duration<double> earned(static_cast<double>(open.bytes) /
                                                   kSlowest_bytes_s);
        if (now - open.moved_at > kSilence || now - open.begun > kSilence + earned) call->cancel();
      }
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::unordered_map<Call*, Open> open_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace irsig
