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

// A group is one combination of the names that the file gives to a triangle, joined by "/" from the
// widest to the most specific, repeated names once: OBJ "o/g/usemtl", STL the solid's name, glTF
// "node/mesh/material"; "default" where the file names nothing. A pattern with * and ? matches the
// whole of it or any one of the names: "ship/hull/steel" is matched by "hull", "st*" and "ship/*".
[[nodiscard]] bool group_matches(std::string_view group, std::string_view pattern);

struct MeshImport {
  std::string file_name;  // its ending says the format
  double unit_m = 1;
  // The file's frame is right-handed: starboard = forward x up. Formats that state one:
  // stated_frame.
  std::string forward_axis = "+x";
  std::string up_axis = "+z";
  // Position of the body frame's origin: "origin" is the file's own (0, 0, 0); "bbox_center" and
  // "bbox_bottom_center" are taken from the box around the triangles, and subtracted in double
  // before anything else, so that a text file in Earth-centred metres loses nothing.
  std::string reference = "origin";
};

// Reads OBJ, PLY, STL, glTF and GLB (buffers inside the file: model_file.h) in double. Polygons
// become triangles; points, lines, normals and texture coordinates are not used. Vertices of OBJ
// and PLY keep the file's order; those of STL and glTF are merged where they are exactly equal.
// Errors name file:line:column for text forms, up to ten at once, and the element for binary ones.
// Refused: an empty mesh, an index out of range, a vertex that is not finite, a polygon that
// crosses itself, axes that are not perpendicular, a mesh that is not 1e-6 to 1e6 m across, a
// mesh of which the rounding to float32 leaves more than 1 % of the area unsure, a mesh
// further from its reference point than 10 times its size (the diagonal of its box), and what
// changes geometry in a way that is not read (docs/reference/file-formats.md).
[[nodiscard]] absl::StatusOr<Mesh> import_mesh(std::string_view bytes, const MeshImport& how);

// Unit and axes that a file states, and the places where it states them. glTF: metres, +z forward,
// +y up, by its standard. OBJ, PLY, STL: the unit, where a comment in front of the data, the name
// of the first solid or the 80 bytes of a binary header name it ("File units = inches"); no axes.
struct StatedFrame {
  std::optional<double> unit_m;
  std::string unit_from;  // "glTF 2.0", or the comment
  std::optional<std::string> forward_axis, up_axis;
  std::string axes_from;
};
[[nodiscard]] StatedFrame stated_frame(std::string_view bytes, const std::string& file_name);

// Position of a mesh in the body frame, after MeshImport::reference.
struct MeshPlacement {
  std::optional<double> draft_m;  // the lowest point is so far below z = 0
  Vec<Body> offset_m{};           // then it is moved
};
void place(Mesh& mesh, const MeshPlacement& where);

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

// Wavefront OBJ, x forward, y PORT, z up (a right-handed frame of the usual kind), one object per
// group; numbers are the shortest that read back as the same double (at most 17 digits):
// import_mesh(write_obj(mesh)) gives the mesh back.
[[nodiscard]] std::string write_obj(const Mesh& mesh);

}  // namespace irsig
