#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/geo/line_of_sight.h"
#include "core/land/height_field.h"

namespace irsig {

// A vertex of the map's edge, where a vertical wall of the land's solid ends at the ground beyond.
struct EdgeStep {
  double x_m = 0, y_m = 0;
  double land_z_m = 0, ground_z_m = 0;
};

// Largest step at the map's edge that counts as none. [m]
inline constexpr double kMostEdgeStepM = 1;

// Returns z of level ground: of the point above (x, y) that lies as high above the ellipsoid as
// (0, 0, surface_m) does. x and y at most 570 km from the origin. Accuracy: 1e-5 m.
[[nodiscard]] double level_z_m(const GeodeticPosition& origin, double surface_m, double x_m,
                               double y_m);

// Returns the vertices of the map's edge where land and the ground beyond differ by more than
// kMostEdgeStepM. That ground is level and goes on at the height of the land below the origin.
// INVALID_ARGUMENT: the origin lies beyond the map.
[[nodiscard]] absl::StatusOr<std::vector<EdgeStep>> edge_steps(const HeightField& land,
                                                               const GeodeticPosition& origin);

// Returns a land whose heights become those of the ground beyond over a width: at the distance d
// from the nearest edge the land stands above that ground by u^2 (3 - 2 u) times what it did, u = d
// / width_m. Its surface at and around the origin stays. width_m = 0: nothing changes.
// INVALID_ARGUMENT: a width that is negative or reaches the cell of the origin.
[[nodiscard]] absl::StatusOr<HeightField> fade_edge(HeightField land,
                                                    const GeodeticPosition& origin, double width_m);

}  // namespace irsig
