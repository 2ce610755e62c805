#pragma once

#include <cstdint>
#include <vector>

#include "core/scene/trace/target.h"
#include "core/signature/measured_view.h"
#include "core/transport/primary_rays.h"

namespace irsig {

// Chooses the facets that get rays of their own: facets that may look so much brighter than all
// others, and are so small, that the remaining undersampling error then asks for fewer samples.
// Without them every sample must stand for little enough that two of the brightest do not matter
// (docs/explanation/methods/transport.md):
//
//   samples  ~  M q_1                           M: the target's mask [m2]; q: radiance that a facet
//   samples  ~  M q_(k+1) + 1.5 A_k q_1         may show / wanted error [1/m2], in falling order;
//                                               A_k: visible area of the k brightest [m2]
//
// Chooses the k that minimises the second, if that is less than a quarter of the first; then cuts
// the facets into at most kMostGroups groups, so that the mask of each is not much more than its
// facets. Facets that all together send less than a tenth of the error get no rays of their own.
inline constexpr std::size_t kMostGroups = 4;
[[nodiscard]] BrightFacets choose_bright(const Target& target, const AimedView& view,
                                         std::vector<FacetBrightness> facets);

// Allocates samples to the strata of such a view, from a pilot of each alone: kLeastShared each,
// then twice as many for the stratum that takes most, per ray, from the error of the row that is
// farthest from kSharedAim of the wanted error, scatter and undersampling together, until no row
// is.
inline constexpr std::uint64_t kLeastShared = 32;
// Less than the 0.8 that other pilots aim at: scatter is not measured with these numbers of
// samples.
inline constexpr double kSharedAim = 0.7;
struct SharedOut {
  std::uint64_t samples = 0;  // of the main stratum
  std::vector<double> share;  // [stratum] relative to it
  double rays = 0;            // that they will take
};
[[nodiscard]] SharedOut share_out(MeasuredView& view, std::uint64_t& pilot_rays);

}  // namespace irsig
