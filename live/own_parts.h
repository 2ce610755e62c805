#pragma once

#include <cstdint>
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

  static constexpr int kRays = 32;  // of each facet

  // emitters: null: the parts
  [[nodiscard]] static OwnParts make(const Target& target, const Emitters* emitters);
};

}  // namespace irsig
