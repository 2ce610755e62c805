#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/thermal/scene/thermal_faces.h"

namespace irsig {

// How much of what a face sends out diffusely arrives at each other face, at the sky and at what
// lies below the horizon. Rows add up to 1; exposed area x share is symmetric to 1e-6.
//
// A ray that meets a facet from behind that has no back began inside a body (where a deckhouse
// stands on a deck): that place of its face is not exposed and does not count. A face with less
// than 1/32 of its places exposed has none, and sees itself alone.
struct ExchangeFactors {
  std::vector<std::size_t> first;  // [face + 1] into the next two
  std::vector<std::uint32_t> to;   // face, increasing in a row
  std::vector<float> share;
  std::vector<float> sky, lower;  // [face]
  std::vector<float> exposed;     // [face] of its area: 0 to 1
};

struct ExchangeSettings {
  std::uint32_t rays = 256;  // of each face, a power of two
  std::uint64_t seed = 1;
  // What lies lower is under water or ground (z of the body frame, down); infinite: no surface.
  double surface_z_m = 0;
};

// By rays: cosine-weighted Sobol points, each face with its own scrambling, so that a face's rays
// depend on nothing but the face. Both estimates of a pair (there and back) are joined with the
// inverses of their variances as weights, F_ij = A_j (f_ij + f_ji) / (A_i + A_j), A exposed; then
// rows are scaled by factors d_i d_j until they add up to 1. Standard error of a share F: sqrt(F /
// rays) at most.
[[nodiscard]] ExchangeFactors exchange_factors(const Target& target, const ThermalFaces& faces,
                                               const ExchangeSettings& settings);

}  // namespace irsig
