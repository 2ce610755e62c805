#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/scene/trace/target.h"
#include "core/sources/source_geometry.h"

namespace irsig {

// Fraction of each facet's surroundings that the target itself hides, from rays spread over its
// hemisphere by the cosine.
struct OwnParts {
  struct Facet {
    float hidden = 0;           // fraction, weighted with the cosine
    std::uint32_t emitter = 0;  // that most of the hidden rays meet
  };
  std::vector<Facet> facet;  // empty: the target is convex
  // Hits of the hidden rays: those of facet f from first_met[f] up to first_met[f + 1].
  struct Met {
    std::uint32_t facet;
    bool from_behind;
  };
  std::vector<Met> met;
  std::vector<std::uint32_t> first_met;

  static constexpr int kRays = 32;  // of each facet

  // Makes the table of a target. emitters: null: the target's parts.
  [[nodiscard]] static OwnParts make(const Target& target, const Emitters* emitters);

  // Returns the mean radiance that arrives at each facet from sunlit parts of the target, per unit
  // irradiance of the sun, as if they reflected diffusely. Whether a facet is in the sun is decided
  // at its middle. [facet] [1/sr]; empty for a convex target.
  //   sun          direction towards it, of length 1
  //   reflectance  of a material at a cosine of incidence
  using Reflectance = std::function<float(std::uint32_t material, float cosine)>;
  [[nodiscard]] std::vector<float> sunlight(const Target& target, Vec<Body> sun,
                                            const Reflectance& reflectance) const;
};

}  // namespace irsig
