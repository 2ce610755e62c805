#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>

namespace irsig {

// For lines of a log whose number is up to strangers: one a second, the others are counted.
// Thread-safe.
class OnceASecond {
 public:
  // How many were not told since the last one that was; nullopt: nor is this one.
  [[nodiscard]] std::optional<std::int64_t> may_tell() {
    const std::int64_t now_s = std::chrono::duration_cast<std::chrono::seconds>(
                                   std::chrono::steady_clock::now().time_since_epoch())
                                   .count();
    if (told_at_s_.exchange(now_s) != now_s) return untold_.exchange(0);
    ++untold_;
    return std::nullopt;
  }

 private:
  std::atomic<std::int64_t> told_at_s_ = -1, untold_ = 0;
};

}  // namespace irsig
