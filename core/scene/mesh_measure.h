#pragma once

#include <cstdint>
#include <vector>

#include "core/scene/mesh.h"

namespace irsig {

// Measures of a mesh, by exact sums over its triangles.
struct MeshMeasure {
  double area_m2 = 0;  // of all facets, hidden ones included
  std::vector<double> group_area_m2;
  double volume_m3 = 0;        // enclosed, by the divergence theorem: overlaps count twice
  Vec<Body> box_min, box_max;  // of the vertices that triangles use
  // Edges that are not shared by exactly two triangles running along them in opposite directions:
  // 0 for closed surfaces.
  std::uint64_t open_edges = 0;
};
[[nodiscard]] MeshMeasure measure(const Mesh& mesh);

[[nodiscard]] std::uint64_t count_degenerate(const Mesh& mesh);

}  // namespace irsig
