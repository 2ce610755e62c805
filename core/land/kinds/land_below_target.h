#pragma once

#include <vector>

#include "core/land/land_kinds.h"
#include "core/land/land_scene.h"

namespace irsig {

// Place and size of a target in the local frame of its land.
struct TargetOnLand {
  double x_m = 0, y_m = 0;  // its middle
  double half_m = 0;        // half of its mean width
  double above_m = 0;       // height of its middle above the land, positive
};

// Returns the kinds of level land that a target's walls see below the horizon, with shares of their
// view factors that add up to 1. The walls are upright, stand half its width from its middle and
// are seen from the height of the middle; land below the target counts as none of it. Empty: no
// land of the map is there.
[[nodiscard]] std::vector<KindShare> land_below_target(const LandScene& land,
                                                       const LandKinds& kinds,
                                                       const TargetOnLand& target);

}  // namespace irsig
