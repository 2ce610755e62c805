#pragma once

#include "core/scene/mesh.h"

namespace irsig {

// Generates a mesh of one kind for generate_mesh. Dimensions are positive and finite, and
// `triangles` is at least the kind's minimum.
[[nodiscard]] Mesh make_disk(double radius_m, std::uint64_t triangles);
[[nodiscard]] Mesh make_sphere(double radius_m, std::uint64_t triangles);
[[nodiscard]] Mesh make_cylinder(double radius_m, double length_m, std::uint64_t triangles);
[[nodiscard]] Mesh make_cone(double radius_m, double length_m, std::uint64_t triangles);
[[nodiscard]] Mesh make_box(Vec<Body> size_m, std::uint64_t triangles);
[[nodiscard]] Mesh make_frigate(double length_m, double width_m, double freeboard_m,
                                std::uint64_t triangles);
// Returns the smallest side of the casing on which the stack fits.
[[nodiscard]] double cooling_tower_reach(double radius_m);
[[nodiscard]] Mesh make_cooling_tower(double radius_m, double length_m, double width_m,
                                      double height_m, std::uint64_t triangles);

}  // namespace irsig
