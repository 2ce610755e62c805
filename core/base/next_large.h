#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <vector>

namespace irsig {

// Finds, in a list of numbers, the next one that is large enough, in time that grows as the
// logarithm of its length.
class NextLarge {
 public:
  explicit NextLarge(const std::vector<double>& value)
      : size_(value.size()), leaves_(std::bit_ceil(value.size() + 1)), most_(2 * leaves_, 0.0) {
    std::copy(value.begin(), value.end(), most_.begin() + static_cast<std::ptrdiff_t>(leaves_));
    for (std::size_t i = leaves_; i-- > 1;) most_[i] = std::max(most_[2 * i], most_[2 * i + 1]);
  }
  // Returns the place of the first sufficient element from `from` on, or the list's length.
  // `enough` is monotonic: of two numbers the larger one is enough where the smaller one is.
  template <typename Enough>
  [[nodiscard]] std::size_t next(std::size_t from, const Enough& enough) const {
    std::size_t i = from + leaves_;
    do {
      while (i % 2 == 0) i /= 2;
      if (enough(most_[i])) {
        while (i < leaves_) {
          i *= 2;
          if (!enough(most_[i])) ++i;
        }
        return std::min(i - leaves_, size_);
      }
      ++i;
    } while ((i & (i - 1)) != 0);
    return size_;
  }

 private:
  std::size_t size_, leaves_;
  std::vector<double> most_;  // of a node's two children; the leaves at last
};

}  // namespace irsig
