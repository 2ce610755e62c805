#pragma once

#include <mutex>

namespace irsig {

// A value that whoever asks for it first makes, from any thread. Private to core/environment.
template <typename T>
class Lazy {
 public:
  template <typename Make>
  const T& get(const Make& make) const {
    std::call_once(once_, [&] { value_ = make(); });
    return value_;
  }

 private:
  mutable std::once_flag once_;
  mutable T value_{};
};

}  // namespace irsig
