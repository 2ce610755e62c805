#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/scene/mesh.h"

namespace irsig {

// One cross-section of a solid that is symmetric about the ship's centre plane, or one of a pair of
// solids to starboard (in) and port. Metres: x forward, y to starboard, h above the waterline; the
// section is a rectangle that leans: `low` is its lower edge, `high` its upper one.
struct Section {
  double x_low, x_high;
  double y_low, y_high;  // outer edge: half-breadths
  double h_low, h_high;
  double y_inner_low = 0, y_inner_high = 0;  // 0: the solid reaches across the centre plane
};

// A closed solid through two or more sections, from aft to fore.
struct Loft {
  std::string side_group, top_group;
  std::vector<Section> section;
  double flare = 0;             // 0 straight sides, 1 sides that spread with the square of height
  bool stations_given = false;  // the sections are the stations: nothing is put between them
};

// Division of a loft into facets about edge_m long.
struct LoftGrid {
  std::vector<Section> section;       // interpolated to every station
  std::vector<std::uint64_t> across;  // divisions of the bottom and top at each station
  std::uint64_t upward = 1;
  std::uint64_t triangles = 0;  // of both halves
};
[[nodiscard]] LoftGrid divide(const Loft& loft, double edge_m);

// Adds the starboard half (open along y = 0 where it reaches the centre plane) to a mesh in the
// body frame.
void add_starboard_half(const Loft& loft, const LoftGrid& grid, Mesh& mesh);

// Completes a starboard half to an exactly symmetric mesh; triangles are sorted by group.
[[nodiscard]] Mesh with_port_half(const Mesh& starboard);

}  // namespace irsig
