#pragma once

#include <array>
#include <string>

#include "core/scene/mesh.h"

namespace irsig {

// The bodies of the matrix of effects (effects_matrix.h). Body frame; fronts face outwards.

// Half of the lengths along x, y, z. [m]
struct HalfSize {
  double x_m, y_m, z_m;
};

// Makes a convex, closed, centred drum along x, of about 300 facets. Group "body".
[[nodiscard]] Mesh drum(double radius_m, double length_m);

// Makes a box of twelve facets. Group "body".
[[nodiscard]] Mesh block(HalfSize half);

// Makes a closed box with a bay that opens to starboard (+y) through a hole in a wall 0.2 m thick.
// Groups "outside" and "inside". `recess` and `hole` are centred on the box's axis; recess.y_m is
// half of the bay's depth, and hole.y_m is not used.
[[nodiscard]] Mesh bay(HalfSize outer, HalfSize recess, HalfSize hole);

// Makes a box whose starboard face holds a square of 2 half_spot_m in a group of its own, "spot".
[[nodiscard]] Mesh block_with_spot(HalfSize half, double half_spot_m);

// Makes a box whose starboard face is the group "mirror", the rest "body".
[[nodiscard]] Mesh block_with_mirror(HalfSize half);

[[nodiscard]] Mesh shifted(Mesh mesh, Vec<Body> by);
// Turns a mesh about the x axis: a face to starboard faces upwards by the angle.
[[nodiscard]] Mesh tilted(Mesh mesh, double up_deg);
// Joins two meshes; groups of the same name become one.
[[nodiscard]] Mesh together(Mesh a, const Mesh& b);
[[nodiscard]] Mesh with_group(Mesh mesh, const std::string& name);

}  // namespace irsig
