#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "core/scene/mesh.h"

namespace irsig {

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

}  // namespace irsig
