// Transforms a file's frame into the body frame.
#include "core/scene/import/import_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/status_macros.h"
#include "core/scene/import/import_formats.h"
#include "core/scene/mesh.h"
#include "core/scene/mesh_measure.h"
#include "fmt/format.h"

namespace irsig {
namespace {

std::optional<Vec<FileFrame>> axis_of(std::string_view name) {
  if (name.size() != 2 || (name[0] != '+' && name[0] != '-')) return std::nullopt;
  const double sign = name[0] == '+' ? 1 : -1;
  switch (name[1]) {
    case 'x':
      return Vec<FileFrame>{sign, 0, 0};
    case 'y':
      return Vec<FileFrame>{0, sign, 0};
    case 'z':
      return Vec<FileFrame>{0, 0, sign};
    default:
      return std::nullopt;
  }
}

bool is_ascii_stl(std::string_view bytes) {
  if (!equals_ignoring_case(TextCursor(bytes).word().text, "solid")) return false;
  // Some programs begin their binary files with "solid" too. Text has no byte 0, and four letters
  // as a number of facets are more than 150 million.
  std::uint64_t facets = 0;
  for (std::size_t i = 4; i-- > 0 && bytes.size() >= 84;)
    facets = facets << 8 | static_cast<unsigned char>(bytes[80 + i]);
  const bool fits = bytes.size() >= 84 && facets > 0 && bytes.size() >= 84 + 50 * facets;
  return !fits && bytes.substr(0, 84).find('\0') == bytes.npos;
}

// The ending says the format, the first bytes whether it is text.
absl::StatusOr<FileMesh> read_file(std::string_view bytes, const std::string& file_name) {
  if (bytes.empty())
    return absl::InvalidArgumentError(fmt::format("{}: the file is empty", file_name));
  if (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff"))
    return absl::InvalidArgumentError(
        fmt::format("{}: this is text in UTF-16, expected UTF-8: save it as UTF-8", file_name));
  const std::string_view ending =
      std::string_view(file_name).substr(std::min(file_name.rfind('.'), file_name.size()));
  const auto is = [&](std::string_view form) { return equals_ignoring_case(ending, form); };
  if (bytes.starts_with("version https://git-lfs"))
    return absl::InvalidArgumentError(fmt::format(
        "{}: this is a pointer of Git LFS, not the model: fetch the model with \"git lfs pull\"",
        file_name));
  std::string_view text = bytes;
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  if (is(".obj")) {
    // DOS programs end a text with Ctrl-Z, others fill the last block with zeros.
    while (!text.empty() && (text.back() == '\x1a' || text.back() == '\0')) text.remove_suffix(1);
    return read_obj(text, file_name);
  }
  if (is(".stl"))
    return is_ascii_stl(text) ? read_ascii_stl(text, file_name) : read_binary_stl(bytes, file_name);
  bytes = text;
  if (is(".ply")) return read_ply(bytes, file_name);
  if (is(".gltf") || is(".glb")) return read_gltf_apart(bytes, file_name);
  return absl::InvalidArgumentError(
      fmt::format("{}: what it is cannot be told from its name, expected .obj, .ply, .stl, .gltf "
                  "or .glb",
                  file_name));
}

struct Box {
  Vec<FileFrame> low, high;
};

Box box_of(const FileMesh& mesh) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Box box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (const auto& triangle : mesh.triangle) {
    for (const std::uint32_t index : triangle) {
      const Vec<FileFrame>& v = mesh.vertex[index];
      box.low = {std::min(box.low.x, v.x), std::min(box.low.y, v.y), std::min(box.low.z, v.z)};
      box.high = {std::max(box.high.x, v.x), std::max(box.high.y, v.y), std::max(box.high.z, v.z)};
    }
  }
  return box;
}

// Halves before adding: the sum may overflow where the middle does not.
Vec<FileFrame> center_of(const Box& box) { return 0.5 * box.low + 0.5 * box.high; }

}  // namespace

absl::StatusOr<Mesh> import_mesh(std::string_view bytes, const MeshImport& how) {
  const auto refuse = [&](const std::string& what) {
    return absl::InvalidArgumentError(fmt::format("{}: {}", how.file_name, what));
  };
  const auto forward = axis_of(how.forward_axis), up = axis_of(how.up_axis);
  if (!forward || !up || dot(*forward, *up) != 0) {
    return refuse(
        fmt::format("forward_axis \"{}\" and up_axis \"{}\", expected two of +x, -x, +y, "
                    "-y, +z, -z that are perpendicular",
                    how.forward_axis, how.up_axis));
  }
  if (!std::isfinite(how.unit_m) || how.unit_m <= 0)
    return refuse(fmt::format("unit_m = {}, expected a positive number of metres", how.unit_m));
  if (how.reference != "origin" && how.reference != "bbox_center" &&
      how.reference != "bbox_bottom_center") {
    return refuse(fmt::format(
        "reference \"{}\", expected origin, bbox_center or bbox_bottom_center", how.reference));
  }

  ASSIGN_OR_RETURN(FileMesh file, read_file(bytes, how.file_name));
  if (file.triangle.empty()) return refuse("the mesh is empty: no facet was found");

  const Box box = box_of(file);
  Vec<FileFrame> origin;
  if (how.reference != "origin") origin = center_of(box);
  if (how.reference == "bbox_bottom_center") {
    const double bottom = std::min(dot(*up, box.low - origin), dot(*up, box.high - origin));
    origin = origin + bottom * *up;
  }
  const double size = length(box.high - box.low), distance = length(center_of(box) - origin);
  if (!std::isfinite(size * how.unit_m) || !std::isfinite(distance * how.unit_m))
    return refuse("the coordinates are too large");
  // Rays are traced in single precision, whose areas end at 1e-38 m2 and lose digits below 1e-30.
  constexpr double kLeastSizeM = 1e-6, kMostSizeM = 1e6;
  if (!(size * how.unit_m >= kLeastSizeM && size * how.unit_m <= kMostSizeM)) {
    return refuse(fmt::format(
        "the mesh is {:.6g} m across ({:.6g} in the file's unit, which is {} m), expected {} to "
        "{} m: is unit_m right?",
        size * how.unit_m, size, how.unit_m, kLeastSizeM, kMostSizeM));
  }
  if (distance > 10 * size) {
    return refuse(
        fmt::format("the mesh ({} across) is {} away from its reference point, in the "
                    "file's unit: say reference = \"bbox_center\" or "
                    "\"bbox_bottom_center\"",
                    size, distance));
  }

  const Vec<FileFrame> starboard = cross(*forward, *up);
  Mesh mesh;
  mesh.vertex.reserve(file.vertex.size());
  for (const Vec<FileFrame>& v : file.vertex) {
    const Vec<FileFrame> from_origin = v - origin;
    // + 0.0 turns -0 into 0, so that equal meshes have equal bytes.
    const Vec<Body> at{how.unit_m * dot(*forward, from_origin) + 0.0,
                       how.unit_m * dot(starboard, from_origin) + 0.0,
                       how.unit_m * -dot(*up, from_origin) + 0.0};
    if (!std::isfinite(at.x) || !std::isfinite(at.y) || !std::isfinite(at.z))
      return refuse("a vertex that no facet uses is too far away");
    mesh.vertex.push_back(at);
  }
  mesh.triangle = std::move(file.triangle);
  mesh.triangle_group = std::move(file.triangle_group);
  mesh.group = std::move(file.group);
  mesh.degenerate_triangles = count_degenerate(mesh);
  if (mesh.degenerate_triangles == mesh.triangle.size())
    return refuse("the mesh is empty: none of its facets has an area");
  return mesh;
}

}  // namespace irsig
