#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/scene/trace/exact_facet.h"

namespace irsig {

// The facets around each vertex, and what a ray meets among them by exact arithmetic.
//
// A traversal in float32 can lose a ray that passes a vertex within rounding: each of the facets
// around it may put the ray on the wrong side of one of its own edges. Every vertex is therefore
// surrounded by a small tetrahedron, its cap. A ray that passes so close meets the cap, and then
// the facets of the vertex are asked here. Vertices at exactly the same place are one.
class VertexFans {
 public:
  // vertex: x y z, triangle: three indices each.
  VertexFans(std::span<const float> vertex, std::span<const std::uint32_t> triangle);

  struct Hit {
    static constexpr std::uint32_t kMiss = 0xffffffffu;
    std::uint32_t facet = kMiss;
    FacetHit at;
    [[nodiscard]] bool met() const { return facet != kMiss; }
  };
  // Returns the nearest facet of one fan on a ray. Where t is the same, the facet that faces the
  // ray wins.
  [[nodiscard]] Hit nearest(std::uint32_t fan, const Point3& origin, const Point3& direction,
                            double t_min) const;
  // Returns the nearest hit among all facets that share a corner with the given one.
  [[nodiscard]] Hit nearest_around(std::uint32_t facet, const Point3& origin,
                                   const Point3& direction, double t_min) const;

  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(centre_.size()); }
  // Corners x y z of the caps, four to a fan, `reach` away from their vertices. A cap encloses a
  // sphere of a third of that.
  [[nodiscard]] std::vector<float> cap_corners(float reach) const;
  [[nodiscard]] Point3 corner(std::uint32_t facet, std::size_t k) const;

 private:
  std::vector<float> vertex_;
  std::vector<std::uint32_t> triangle_;
  void add_fan(std::uint32_t fan, const Point3& origin, const Point3& direction, double t_min,
               Hit& best) const;

  std::vector<std::uint32_t> fan_of_;  // by vertex
  std::vector<std::uint32_t> centre_;  // a vertex of each fan
  std::vector<std::uint32_t> first_;   // into facet_, count() + 1 entries
  std::vector<std::uint32_t> facet_;
};

}  // namespace irsig
