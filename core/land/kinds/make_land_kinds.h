#pragma once

#include <cstdint>
#include <vector>

#include "core/land/land_kinds.h"
#include "core/land/land_scene.h"

namespace irsig {

// Finds the horizons of land around its target and the kinds that stand for all of it.
//   computed    [material] whether its temperature is computed
//   on_objects  [material] whether objects have it
//   held_out    places of each computed material that are to be held out
[[nodiscard]] LandKinds make_land_kinds(const LandScene& land, std::vector<bool> computed,
                                        std::vector<bool> on_objects, std::uint32_t held_out);

}  // namespace irsig
