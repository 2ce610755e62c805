#pragma once

#include <vector>

#include "core/thermal/scene/scene_exposure.h"
#include "core/thermal/scene/scene_walls.h"

namespace irsig {

// Upper bound on the temperature change of a facet if an effect were toggled: at any time, both of
// its faces. By the maximum principle (docs/explanation/methods/thermal.md, "What is left out").
// Infinite: no bound is known. 0 of facets without wall. [facet] [K]
struct HeatBounds {
  std::vector<double> exchange_k, diffuse_sun_k;
};

// Computes the bounds of settled walls; `exposure` is theirs. Where both effects are off, the sum
// of both bounds covers both.
[[nodiscard]] HeatBounds heat_bounds(const SceneHeatRequest& request, SceneExposure& exposure,
                                     const SceneWalls& walls);

}  // namespace irsig
