#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "core/base/sobol.h"
#include "core/materials/material_spec.h"

namespace irsig {

// A hash from which the seeds of random numbers are made: order matters, names do not enter.
class Hash {
 public:
  void add(std::uint64_t x) { state_ = mix64(state_ ^ x); }
  void add(double x) { add(std::bit_cast<std::uint64_t>(x)); }
  void add(const std::vector<float>& v) {
    add(static_cast<std::uint64_t>(v.size()));
    for (const float x : v) add(static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(x)));
  }
  void add(const MaterialSpec& spec);
  [[nodiscard]] std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0x6972736967ULL;
};

}  // namespace irsig
