#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/thermal/scene/thermal_faces.h"

namespace irsig {

// Fractions of a face's diffuse emission that arrive at each other face, at the sky and at the
// surface below the horizon. Rows add up to 1; exposed area x fraction is symmetric to 1e-6.
//
// A ray that meets a facet from behind that has no back began inside a body (where a deckhouse
// stands on a deck): that place of its face is not exposed and does not count. A face with less
// than 1/32 of its places exposed has none: it is dark, its row is empty, it exchanges nothing.
//
// A face behind whose plane all of the target lies sees sky and lower hemisphere alone, by the
// closed form: sky = (1 + cos t) / 2, t its tilt from lying face up.
struct ExchangeFactors {
  std::vector<std::size_t> first;  // [face + 1] into the next two
  std::vector<std::uint32_t> to;   // face, increasing in a row
  std::vector<float> share;
  std::vector<float> sky, lower;  // [face]
  std::vector<float> exposed;     // [face] of its area: 0 to 1
  // [face] How much places of a face differ, root mean square over it, as far as rays tell it from
  // chance: in their shares of the sky and of what lies below the horizon, and in what would arrive
  // from the aims as below [W/m2].
  std::vector<float> uneven_sky, uneven_lower, uneven_aims_w_m2;
  // Distribution of each face's rays that are not aimed, in kBlocks parts of them, each spread
  // evenly: the differences between the blocks estimate the error of the arriving radiation. A face
  // that is known by the closed form, or dark, has none. Empty unless asked for.
  static constexpr std::size_t kBlocks = 8;
  struct Hits {
    std::uint32_t to;  // face; ThermalFaces::kNone: one that is aimed at
    std::uint16_t block, count;
  };
  std::vector<std::size_t> first_hit;  // [face + 1] into the next
  std::vector<Hits> hit;
  // [face x kBlocks + block] Rays to the sky, to what lies below, and all that count.
  std::vector<std::uint16_t> sky_hits, lower_hits, all_hits;
  // [face] Of what would arrive from the aims if each sent what it may send beyond the others: by
  // eight parts of the aimed rays, each spread evenly, so that it is rather too large. [W/m2]
  std::vector<float> aimed_stderr_w_m2;
};

struct ExchangeSettings {
  std::uint32_t rays = 256;  // of each face, a power of two
  std::uint64_t seed = 1;
  // Height below which faces are under water or ground (z of the body frame, down); infinite: no
  // surface.
  double surface_z_m = 0;
  // [face] By how much what it sends may differ from what is around it; empty: of none. What a
  // ray that misses it would matter for is aimed at, with half as many rays more.
  std::span<const double> beyond_w_m2 = {};
  bool keep_hits = false;  // whether ExchangeFactors has first_hit and the rest of its blocks
};

// Computes the factors by rays: cosine-weighted Sobol points, each face with its own scrambling, so
// that a face's rays depend on nothing but the face. Each ray that joins two faces, from either of
// them and aimed or not, counts by the density of all rays that might have [veach1995]: of n rays
// and none aimed, F_ij = A_j (f_ij + f_ji) / (A_i + A_j). Then rows are scaled by factors d_i d_j
// until they add up to 1. Standard error of a fraction F: sqrt(F / rays) at most, far less for
// aims.
[[nodiscard]] ExchangeFactors exchange_factors(const Target& target, const ThermalFaces& faces,
                                               const ExchangeSettings& settings);

}  // namespace irsig
