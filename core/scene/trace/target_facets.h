#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <vector>

#include "core/scene/trace/target.h"

namespace irsig {

// The sets of parts that have vertices above the plane of a facet.
struct PartsAbove {
  std::vector<std::vector<bool>> set;  // [set][part], all that occur; the first is empty
  // [facet] Index of the set above its front and, of two-sided facets, above its back; else 0.
  std::vector<std::array<std::uint32_t, 2>> of_facet;
  std::vector<std::vector<bool>> of_part;  // [part][part] above any of its facets, on either side
};

// Facets that face nearly the same way, of one material, either all one-sided or all two-sided.
struct Facing {
  Vec<Body> normal;
  double area_m2, bent;  // bent: largest angle between `normal` and a facet's normal [rad]
  std::uint32_t material;
  bool two_sided;
};

// Normals are gathered in cells this wide: a fiftieth of the sun's radius. The largest radiance of
// light at grazing angles changes so fast that wider cells would ask for many times the samples.
inline constexpr double kFacingCell = 1e-4;

// Properties of a target's facets that all of its views share. Each is computed at the first
// question. Any number of threads may ask, always with the same target.
class TargetFacets {
 public:
  [[nodiscard]] const PartsAbove& parts_above(const Target& target) const;
  // Returns all facets of positive area.
  [[nodiscard]] const std::vector<Facing>& facings(const Target& target) const;

 private:
  mutable std::once_flag above_made_, facings_made_;
  mutable PartsAbove above_;
  mutable std::vector<Facing> facing_;
};

// Returns the angle between two unit vectors, also where it is small. [rad]
[[nodiscard]] double angle_between(Vec<Body> a, Vec<Body> b);

}  // namespace irsig
