#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace irsig {

// Triangles joined two by two across a common edge, so that the ray tracer's tree has half as many
// leaves: on the frigate (200 000 facets) scattered rays cost 0.72, diffuse reflections 0.92 of
// what they cost on single triangles, which pays for the guard at the vertices
// (docs/evidence/performance.md). The two facets of a pair need not lie in a plane. A pair (v0, v1,
// v2, v3) is the triangles (v0, v1, v3) and (v2, v3, v1), as Embree has it.
class FacetPairs {
 public:
  // vertex: x y z, triangle: three indices each.
  FacetPairs(const std::vector<float>& vertex, const std::vector<std::uint32_t>& triangle);

  // Four vertex indices each; the last two are equal where a facet is alone.
  [[nodiscard]] const std::vector<std::array<std::uint32_t, 4>>& corner() const { return corner_; }
  // Returns the first and the second facet of each pair, and leaves none behind.
  [[nodiscard]] std::vector<std::array<std::uint32_t, 2>> take_facets() {
    return std::move(facet_);
  }

 private:
  std::vector<std::array<std::uint32_t, 4>> corner_;
  std::vector<std::array<std::uint32_t, 2>> facet_;
};

}  // namespace irsig
