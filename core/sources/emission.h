#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/sources/source_geometry.h"

namespace irsig {

// Temperatures of emitters under one condition. [emitter]
struct EmitterTemperatures {
  std::vector<float> kelvin;  // NaN: the one that is stated for its part
  // The true one lies within kelvin +- error_k; NaN likewise. Infinite: nothing is known of it, and
  // kelvin stands for it in views that do not see it.
  std::vector<float> error_k;
  // Extremes of the finite temperatures, finite errors included. [K]
  double coldest_k = 0, hottest_k = 0;
};

// Largest allowed kelvin + error_k; kelvin - error_k is 1 K or more.
inline constexpr double kMostEmitterK = 10'000;

// Temperatures of facets under one condition. [facet], as above
struct FacetTemperatures {
  std::vector<float> kelvin, error_k;
};

// Emitters for parts whose facets have temperatures of their own: facets of a part that have the
// same temperatures and errors under every condition share one.
struct ElementEmission {
  Emitters emitters;
  std::vector<EmitterTemperatures> condition;
};
// Returns the emitters of all facets and their temperatures under each condition. A facet whose
// temperature is NaN under every condition belongs to the emitter of its whole part.
//   part_of_facet  [facet]
//   condition      [condition], each of all facets
[[nodiscard]] ElementEmission make_element_emission(std::span<const std::uint32_t> part_of_facet,
                                                    std::size_t parts,
                                                    std::span<const FacetTemperatures> condition);

// Blackbodies that stand for all others: at equal steps of 1 / T, between which radiance follows
// from four of them by Lagrange's cubic. A sum over emitters of weight x B(lambda, T) becomes one
// over a few dozen blackbodies, whatever the wavelengths.
class BlackbodyNodes {
 public:
  BlackbodyNodes() = default;
  // Makes the nodes for temperatures between the two, 1 K to kMostEmitterK. [K]
  BlackbodyNodes(double coldest_k, double hottest_k);

  [[nodiscard]] std::uint32_t count() const { return count_; }
  [[nodiscard]] double kelvin(std::uint32_t node) const;

  struct Share {
    std::uint32_t first = 0;  // of four nodes side by side
    std::array<double, 4> weight{};
  };
  [[nodiscard]] Share share(double kelvin) const;

  // Returns the largest relative error of an interpolated radiance, at wavelengths from this one
  // on. With x = c2 / (lambda T), n = 1 / (exp(x) - 1) and a step h of x: 9/384 h^4 n'''' at the
  // hottest node / n at the coldest, since all derivatives of n fall in size with x. The step of 1
  // / T is 2e-5 / K: 2e-6 at 3 um and 300 K, 1e-5 at 2 um.
  [[nodiscard]] double relative_error(double shortest_um) const;

 private:
  std::uint32_t first_ = 0, count_ = 0;  // the first one's 1 / T in steps
};

}  // namespace irsig
