#pragma once

#include <atomic>
#include <cstdint>

namespace irsig {

// A number of bytes, or of anything else, that all calls together may hold. Thread-safe.
class SharedLimit {
 public:
  explicit SharedLimit(std::uint64_t most) : most_(most) {}

  // Takes `amount` from the limit. Returns false, and takes nothing, if the limit would be
  // exceeded.
  [[nodiscard]] bool take(std::uint64_t amount) {
    std::uint64_t taken = taken_.load();
    do {
      if (amount > most_ - taken) return false;
    } while (!taken_.compare_exchange_weak(taken, taken + amount));
    return true;
  }
  void give_back(std::uint64_t amount) { taken_ -= amount; }

 private:
  const std::uint64_t most_;
  std::atomic<std::uint64_t> taken_ = 0;
};

// A part of a shared limit, given back at the end. Belongs to one call.
class Share {
 public:
  explicit Share(SharedLimit& limit) : limit_(limit) {}
  ~Share() { release(); }
  Share(const Share&) = delete;
  Share& operator=(const Share&) = delete;

  [[nodiscard]] bool take(std::uint64_t amount) {
    if (!limit_.take(amount)) return false;
    taken_ += amount;
    return true;
  }
  void release() {
    limit_.give_back(taken_);
    taken_ = 0;
  }

 private:
  SharedLimit& limit_;
  std::uint64_t taken_ = 0;
};

}  // namespace irsig
