#pragma once

#include <cstdint>

#include "core/base/sobol.h"
#include "core/materials/material.h"

namespace irsig {

// Do directions drawn from a material follow the density that it states?
struct DirectionCheck {
  double p_value;         // of chi-square over `bins`, the directions below the surface among them
  int bins;               // of at least 10 expected directions each
  double integral;        // of the density over the hemisphere
  double fraction_above;  // of the directions drawn
};

// Draws `samples` independent directions for one w_o from one material and compares them with the
// density that a material (the same one, unless a test wants to see the difference) states. The
// bins are rings of their half vector's angle (as wide as the material's narrowest lobe needs) x 16
// azimuths; expected counts are integrals of density_per_sr (32 x 32 Gauss points per bin: 1e-6 of
// it for smooth lobes, 1e-3 for the staircase of a table).
[[nodiscard]] DirectionCheck check_directions(const Material& drawn_from, const Material& stated,
                                              double cos_o, std::uint32_t samples,
                                              std::uint64_t seed);

// Returns the probability that chi-square with so many degrees of freedom is at least this large.
// [dlmf, 8.11.4, 8.9.2]
[[nodiscard]] double chi_square_p_value(double statistic, int degrees_of_freedom);

// Independent numbers in (0, 1), the same everywhere for one seed.
class UniformNumbers {
 public:
  explicit UniformNumbers(std::uint64_t seed) : state_(seed) {}
  float next() { return unit_float(static_cast<std::uint32_t>(mix64(state_++) >> 32)); }

 private:
  std::uint64_t state_;
};

}  // namespace irsig
