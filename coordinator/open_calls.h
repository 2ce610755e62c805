#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <unordered_map>

namespace irsig {

// Streams that are being received. One whose sender says nothing for kSilence is cancelled: a call
// that is left half open would keep what it holds for ever. Thread-safe.
class OpenCalls {
 public:
  static constexpr auto kSilence = std::chrono::seconds(60);

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

  void add(Call& call) { heard(call, true); }
  void heard(Call& call) { heard(call, false); }
  void remove(Call& call) {
    const std::lock_guard lock(mutex_);
    heard_at_.erase(&call);
  }

 private:
  using Steady = std::chrono::steady_clock;

  void heard(Call& call, bool is_new) {
    const std::lock_guard lock(mutex_);
    if (is_new || heard_at_.contains(&call)) heard_at_[&call] = Steady::now();
  }

  void watch() {
    std::unique_lock lock(mutex_);
    while (!changed_.wait_for(lock, kSilence / 8, [this] { return ending_; })) {
      const auto now = Steady::now();
      for (auto& [call, at] : heard_at_)
        if (now - at > kSilence) call->cancel();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::unordered_map<Call*, Steady::time_point> heard_at_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace irsig
