#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <unordered_map>

namespace irsig {

// Registered workers and their leases. The farm writes the book; the receiver of a result reads it
// before accepting the result's bytes. Thread-safe.
class LeaseBook {
 public:
  void registered(const std::string& worker_id) { hold(worker_id, 0); }
  void hold(const std::string& worker_id, std::uint64_t fencing_token) {
    const std::lock_guard lock(mutex_);
    token_[worker_id] = fencing_token;
  }
  // Ends the worker's lease; the worker stays registered.
  void release(const std::string& worker_id) {
    const std::lock_guard lock(mutex_);
    const auto found = token_.find(worker_id);
    if (found != token_.end()) found->second = 0;
  }
  void forget(const std::string& worker_id) {
    const std::lock_guard lock(mutex_);
    token_.erase(worker_id);
  }
  [[nodiscard]] bool knows(const std::string& worker_id) const {
    const std::lock_guard lock(mutex_);
    return token_.contains(worker_id);
  }
  [[nodiscard]] bool holds(const std::string& worker_id, std::uint64_t fencing_token) const {
    const std::lock_guard lock(mutex_);
    const auto found = token_.find(worker_id);
    return found != token_.end() && fencing_token != 0 && found->second == fencing_token;
  }

 private:
  mutable std::mutex mutex_;
  std::unordered_map<std::string, std::uint64_t> token_;
};

}  // namespace irsig
