#pragma once

#include <vector>

#include "core/scene/target.h"
#include "core/signature/pass.h"
#include "core/transport/primary_rays.h"

namespace irsig {

// Which facets get rays of their own: those that may look so much brighter than all others, and are
// so small, that what is unseen then asks for fewer samples. Without them every sample must stand
// for little enough that two of the brightest do not matter (docs/methods/transport.md):
//
//   samples  ~  M q_1                           M: the target's mask [m2]; q: radiance that a facet
//   samples  ~  M q_(k+1) + 1.5 A_k q_1         may show / error that is wanted [1/m2], in falling
//                                               order; A_k: what is seen of the k brightest [m2]
//
// The k that makes the second least, if that is less than a quarter of the first; then cut into at
// most kMostGroups groups, so that the mask of each is not much more than its facets. Facets that
// all together send less than a tenth of the error are left where they are.
inline constexpr std::size_t kMostGroups = 4;
[[nodiscard]] BrightFacets choose_bright(const Target& target, const AimedView& view,
                                         std::vector<Pass::Brightness> facets);

}  // namespace irsig
