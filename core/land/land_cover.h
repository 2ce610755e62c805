#pragma once

#include <cstdint>
#include <span>

namespace irsig {

// Which materials cover the land: the fraction of each at every place.
class LandCover {
 public:
  // One material everywhere.
  LandCover() = default;

  [[nodiscard]] std::uint32_t materials() const { return 1; }

  // Computes the fractions of the materials at (x, y) of the land's local frame. They are not
  // negative and add up to 1.
  //   fraction  [materials()]
  void at(double x_m, double y_m, std::span<float> fraction) const;
};

}  // namespace irsig
