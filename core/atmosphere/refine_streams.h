#pragma once

#include <span>
#include <vector>

#include "core/atmosphere/two_stream.h"

namespace irsig {

// Returns light at the layers' boundaries that is nearer to the truth than two streams' light:
// twice, the source that the light makes is integrated along eight directions through all layers,
// and the moments of the radiance found replace the light's. The source is linear in optical depth
// inside a layer, the sun's beam exponential, and the phase function of what the beam scatters that
// of Henyey and Greenstein.
//
//   light  of diffuse_light() with the same layers and boundaries, from the top down
//
// Limits: layers whose source bends within them, as that of sunlight in layers thicker than about
// 2, are better off without it. Accuracy: tests/physics/fog_light_test.cpp compares paths in fog
// with photons followed one by one.
[[nodiscard]] std::vector<StreamLight> refined_light(std::vector<StreamLight> light,
                                                     std::span<const StreamLayer> layers,
                                                     const StreamBoundaries& boundaries);

}  // namespace irsig
