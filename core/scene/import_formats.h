#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/status/statusor.h"
#include "core/geo/frames.h"
#include "core/scene/import_text.h"

namespace irsig {

struct FileFrame {};  // the axes, unit and origin of a mesh file

// What a file holds, as it stands there.
struct FileMesh {
  std::vector<Vec<FileFrame>> vertex;
  std::vector<std::array<std::uint32_t, 3>> triangle;
  std::vector<std::uint32_t> triangle_group;
  std::vector<std::string> group;
};

// One reader per form; each returns a mesh with finite vertices and indices in range.
[[nodiscard]] absl::StatusOr<FileMesh> read_obj(std::string_view text,
                                                const std::string& file_name);
[[nodiscard]] absl::StatusOr<FileMesh> read_ply(std::string_view bytes,
                                                const std::string& file_name);
[[nodiscard]] absl::StatusOr<FileMesh> read_ascii_stl(std::string_view text,
                                                      const std::string& file_name);
// form: "ply", "stl", "gltf" or "glb". Refuses a file whose float32 spacing is too coarse (mesh.h).
[[nodiscard]] absl::StatusOr<FileMesh> read_float32(std::string_view bytes,
                                                    const std::string& file_name,
                                                    const std::string& form);

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
