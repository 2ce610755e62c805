#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/scene/mesh.h"

namespace irsig {

// A parametric model: disk | sphere | box | cylinder | cone | frigate | cooling_tower, about
// `triangles` triangles (how closely: generate_solids.cpp, frigate.cpp). Dimensions of 0 mean the
// generator's default; a dimension that a kind does not have is an error. Body frame; smallest
// `triangles` in []:
//   disk      [3] radius (1), in the plane x = 0, facing +x, one-sided
//   sphere    [8] radius (1), centred
//   box       [12] length x width x height along x, y, z (2, 1, 0.5), centred
//   cylinder  [12] radius (0.5), length (3) along x, closed, centred
//   cone      [6] radius (1), length (2): nose at +x, base disk at -x, closed; origin at the middle
//             of its axis
//   frigate   [2000] 153.8 x 20.4 m, 6.4 m freeboard amidships (length, width and height scale it);
//             origin midships on the waterline; closed surfaces upwards from 1 mm above the
//             waterline, exactly symmetric. Groups: hull, deck, superstructure, funnel, funnel_top,
//             mast, mast_hot, turret
//   cooling_tower [416] a mechanical-draft counter-flow cell. radius (4) of the fan stack's throat;
//             casing of length x width (12 x 12) along x and y and height (10) from the ground to
//             the deck. In throat radii: the deck is 0.36 below the throat and the stack's exit
//             0.44 above it, a hyperboloid of 1.07 at the deck and 1.10 at the exit; walls are 0.02
//             thick; the hub is a disc of 0.25, 0.1 thick, in the throat. The ground is a disc
//             whose radius is the casing's diagonal. The fill's surface is 0.3 heights below the
//             deck. Origin in the middle of the throat. Casing, deck, stack, plenum and fill are
//             one closed surface, the hub another; the ground is open. Fan blades and louvres are
//             left out. Groups: casing, deck, stack_outside, stack_rim, stack_inside, plenum, fill,
//             hub, ground
//
// Round solids are made of planar facets, so their size is chosen to be right on the average:
//   disk, cylinder, cone  every cross-section is a regular polygon of m corners, m odd, with the
//   AREA
//             of the true circle: areas along the axis are exact; widths across it are too large by
//             1.645 / m^2 in the mean over azimuth and by 0.82 / m^2 to 2.47 / m^2 at each; other
//             silhouettes are right within -3.3 / m^2 and +6.6 / m^2 (the circles in and around the
//             polygon), the largest seen is 3.2 / m^2. m is 2.5, 1.3, 2.1 x sqrt(triangles) for the
//             default disk, cylinder, cone.
//   sphere    its surface is exactly 4 pi R^2, so that by Cauchy's theorem the mean projected area
//             is pi R^2; one direction differs by less than 3 / triangles (of pi R^2)
// (tests/physics/mesh_geometry_test.cpp).
struct MeshGenerator {
  std::string kind;
  std::uint64_t triangles = 0;
  double radius_m = 0, length_m = 0, width_m = 0, height_m = 0;
};
[[nodiscard]] std::vector<std::string> generator_kinds();
[[nodiscard]] absl::StatusOr<Mesh> generate_mesh(const MeshGenerator& what);

}  // namespace irsig
