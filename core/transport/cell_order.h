#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/sobol.h"

namespace irsig {

// Finds the sample of a scrambled Sobol replicate in a given small square of the unit square.
//
// Of n samples, at most one of each replicate lies in a square of side 2^-m, m = ceil(log4 n).
// Visiting the squares one after the other, and in each all replicates, gives rays that hit the
// same few facets - without sorting, since the scrambled sequence can be inverted: the first
// coordinate's upper m bits are a permutation of the index's lower m bits, the second's a
// permutation of a linear map of its lower 2m bits (core/base/sobol.h).
class CellOrder {
 public:
  CellOrder(std::uint64_t samples, std::span<const SeedPair> seed_of_replicate);

  // Squares along one side.
  [[nodiscard]] std::uint32_t side() const { return 1u << bits_; }
  static constexpr std::uint32_t kNone = 0xffffffffu;

  // Returns the index of replicate r's sample in square (x, y), or kNone if it is not among the n
  // first.
  [[nodiscard]] std::uint32_t sample(std::uint32_t r, std::uint32_t x, std::uint32_t y) const {
    const std::uint32_t low = inverse_x_[(r << bits_) + x];
    const std::uint32_t high =
        high_of_[inverse_y_[(r << bits_) + y] ^ (second_coordinate_reversed(low) & (side() - 1))];
    const std::uint32_t index = low | (high << bits_);
    return index < samples_ ? index : kNone;
  }

 private:
  std::uint32_t bits_ = 0;
  std::uint32_t samples_ = 0;
  std::vector<std::uint32_t> inverse_x_,
      inverse_y_;  // [replicate][cell]: the reversed coordinate before scrambling
  std::vector<std::uint32_t>
      high_of_;  // the index's upper m bits behind a value of their linear map
};

// Returns the even bits of a Morton code.
[[nodiscard]] constexpr std::uint32_t compact_even_bits(std::uint64_t code) {
  code &= 0x5555555555555555ULL;
  code = (code | (code >> 1)) & 0x3333333333333333ULL;
  code = (code | (code >> 2)) & 0x0f0f0f0f0f0f0f0fULL;
  code = (code | (code >> 4)) & 0x00ff00ff00ff00ffULL;
  code = (code | (code >> 8)) & 0x0000ffff0000ffffULL;
  return static_cast<std::uint32_t>((code | (code >> 16)) & 0xffffffffULL);
}

}  // namespace irsig
