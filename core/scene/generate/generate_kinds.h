#pragma once

#include "core/scene/mesh.h"

namespace irsig {

// The generators behind generate_mesh: dimensions are positive and finite, `triangles` is at least
// the kind's minimum.
[[nodiscard]] Mesh make_disk(double radius_m, std::uint64_t triangles);
[[nodiscard]] Mesh make_sphere(double radius_m, std::uint64_t triangles);
[[nodiscard]] Mesh make_cylinder(double radius_m, double length_m, std::uint64_t triangles);
[[nodiscard]] Mesh make_cone(double radius_m, double length_m, std::uint64_t triangles);
[[nodiscard]] Mesh make_box(Vec<Body> size_m, std::uint64_t triangles);
[[nodiscard]] Mesh make_frigate(double length_m, double width_m, double freeboard_m,
                                std::uint64_t triangles);
// The smallest casing side that the stack fits on.
[[nodiscard]] double cooling_tower_reach(double radius_m);
[[nodiscard]] Mesh make_cooling_tower(double radius_m, double length_m, double width_m,
                                      double height_m, std::uint64_t triangles);

}  // namespace irsig
