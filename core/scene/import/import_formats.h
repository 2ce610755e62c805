#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/status/statusor.h"
#include "core/geo/frames.h"
#include "core/scene/import/import_text.h"

namespace irsig {

struct FileFrame {};  // the axes, unit and origin of a mesh file

// The content of a mesh file, in its own axes and unit.
struct FileMesh {
  std::vector<Vec<FileFrame>> vertex;
  std::vector<std::array<std::uint32_t, 3>> triangle;
  std::vector<std::uint32_t> triangle_group;
  std::vector<std::string> group;
};

// Reads one format each. Each reader returns a mesh with finite vertices and indices in range.
[[nodiscard]] absl::StatusOr<FileMesh> read_obj(std::string_view text,
                                                const std::string& file_name);
[[nodiscard]] absl::StatusOr<FileMesh> read_ply(std::string_view bytes,
                                                const std::string& file_name);
[[nodiscard]] absl::StatusOr<FileMesh> read_ascii_stl(std::string_view text,
                                                      const std::string& file_name);
[[nodiscard]] absl::StatusOr<FileMesh> read_binary_stl(std::string_view bytes,
                                                       const std::string& file_name);
// Reads glTF and GLB, in this process.
[[nodiscard]] absl::StatusOr<FileMesh> read_gltf(std::string_view bytes,
                                                 const std::string& file_name);
// Like read_gltf(), in a process of its own, with limits of memory and time (docs/decisions/0021).
[[nodiscard]] absl::StatusOr<FileMesh> read_gltf_apart(std::string_view bytes,
                                                       const std::string& file_name);

// Reads three coordinates from the current line or lines; reports what is wrong with them.
[[nodiscard]] bool coordinate_of(const Token& word, FileErrors& errors, double& out);

// Names of groups to numbers, in order of first use.
class GroupTable {
 public:
  explicit GroupTable(FileMesh& mesh) : mesh_(mesh) {}
  // Joins the names by "/", each once, empty ones left out; "default" when nothing is left.
  [[nodiscard]] static std::string join(const std::vector<std::string>& names);
  [[nodiscard]] std::uint32_t number(const std::string& name);

 private:
  FileMesh& mesh_;
  std::unordered_map<std::string, std::uint32_t> number_;
};

// Judges coordinates that a file holds in float32 by the area that their rounding leaves unsure: of
// a facet, half the spacing of float32 at its farthest coordinate times its longest edge. A sliver
// in a large model is no loss; a model in Earth-centred metres is.
class Float32Guard {
 public:
  // Adds a triangle with the corners of the file. `area_scale` is the factor by which the model
  // enlarges areas.
  void add(const Vec<FileFrame>& a, const Vec<FileFrame>& b, const Vec<FileFrame>& c,
           double area_scale = 1);
  // Returns what is wrong where more than 1 % of the area is unsure, and what to do.
  [[nodiscard]] std::optional<std::string> problem() const;

 private:
  double area_ = 0, unsure_area_ = 0, coarsest_ = 0;
};

// One vertex for each different position; 0 and -0 are the same.
class VertexMerger {
 public:
  explicit VertexMerger(FileMesh& mesh) : mesh_(mesh) {}
  [[nodiscard]] std::uint32_t number(const Vec<FileFrame>& at);

 private:
  FileMesh& mesh_;
  absl::flat_hash_map<std::array<std::uint64_t, 3>, std::uint32_t> number_;
};

// Adds the polygon's triangles; false when it crosses itself. Corners must be vertices of the mesh.
// Convex polygons become a fan, others are cut ear by ear.
[[nodiscard]] bool add_polygon(const std::vector<std::uint32_t>& corner, std::uint32_t group,
                               FileMesh& mesh);

// Concave polygons are cut in time n^2 to n^3: more corners than this are refused.
inline constexpr std::size_t max_concave_corners = 2000;

}  // namespace irsig
