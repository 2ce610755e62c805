#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "core/atmosphere/absorber_amounts.h"

namespace irsig {

// Lagrange's polynomial through up to four neighbours of x. Private to core/environment, as all of
// this header.
struct Stencil {
  std::size_t first = 0, count = 0;
  std::array<double, 4> weight{};
};
[[nodiscard]] Stencil cubic(const std::vector<double>& at, double x);

// Rings at which near air is taken into account exactly; between them the ratio of the radiance
// behind near air to that at the target, a smooth function, is cubic in the number of the ring.
// What is not asked for is not computed. Not for several threads.
class RingRatios {
 public:
  using Exact = std::function<AirSpectrum(std::size_t ring)>;
  RingRatios(std::size_t rings, Exact exact);

  // Returns the rings of so many that are computed exactly, increasing.
  [[nodiscard]] static std::vector<std::size_t> exact_rings(std::size_t rings);

  // Returns the ratio of a ring; it does not depend on the rings asked for before.
  [[nodiscard]] AirSpectrum at(std::size_t ring);
  // Interpolates linearly between the first, a middle and the last of the exact rings.
  [[nodiscard]] AirSpectrum coarse(std::size_t ring);
  [[nodiscard]] std::size_t rings() const { return rings_; }

  // Returns the rings from which coarse() interpolates.
  [[nodiscard]] std::array<std::size_t, 3> coarse_rings() const;

 private:
  const AirSpectrum& exact(std::size_t which);

  std::size_t rings_;
  Exact compute_;
  std::vector<std::size_t> exact_ring_;
  std::vector<std::optional<AirSpectrum>> known_;  // [exact ring]
};

}  // namespace irsig
