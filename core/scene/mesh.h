#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geo/frames.h"

namespace irsig {

// A triangle mesh in the body frame, in metres, in double. Front faces are counter-clockwise seen
// from outside.
struct Mesh {
  std::vector<Vec<Body>> vertex;
  std::vector<std::array<std::uint32_t, 3>> triangle;
  std::vector<std::uint32_t> triangle_group;  // index into group, one per triangle
  std::vector<std::string> group;             // see group_matches; in order of first use
  // Triangles whose area vanishes (2 area <= 1e-12 x longest edge squared). They stay in the mesh;
  // no ray meets them.
  std::uint64_t degenerate_triangles = 0;
};

// Returns true if a pattern with * and ? matches the whole group, or any one of its names: "hull",
// "st*" and "ship/*" match "ship/hull/steel". A group joins by "/", from the widest to the most
// specific, the names that the file gives to a triangle, repeated names once: OBJ "o/g/usemtl", STL
// the solid's name, glTF "node/mesh/material"; "default" without a name.
[[nodiscard]] bool group_matches(std::string_view group, std::string_view pattern);

// Position of a mesh in the body frame, after MeshImport::reference.
struct MeshPlacement {
  std::optional<double> draft_m;  // the lowest point is so far below z = 0
  Vec<Body> offset_m{};           // then it is moved
};
void place(Mesh& mesh, const MeshPlacement& where);

// Writes Wavefront OBJ, x forward, y PORT, z up (a right-handed frame of the usual kind), one
// object for each group. Numbers are the shortest that read back as the same double, so that
// import_mesh(write_obj(mesh)) returns the mesh.
[[nodiscard]] std::string write_obj(const Mesh& mesh);

}  // namespace irsig
