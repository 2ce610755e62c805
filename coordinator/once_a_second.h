#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>

namespace irsig {

// Limits log lines whose number strangers control to one a second; the others are counted.
// Thread-safe.
class OnceASecond {
 public:
  // Returns the number of lines suppressed since the last one allowed; nullopt: suppress this line
  // too.
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
