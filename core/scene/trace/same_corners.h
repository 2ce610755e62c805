#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace irsig {

// Facets that lie exactly on each other: a ray meets all of them at one distance, and which one a
// traversal reports would depend on the order of its tree. Only the first of each such set is
// traced; which facet of the set is meant is chosen afterwards. Facets that are alone cost nothing.
class SameCorners {
 public:
  // vertex: x y z, triangle: three indices each.
  SameCorners(std::span<const float> vertex, std::span<const std::uint32_t> triangle);

  [[nodiscard]] bool empty() const { return same_.empty(); }
  // Returns the triangles, with all but the first of each set collapsed to a point, which no ray
  // meets.
  [[nodiscard]] std::vector<std::uint32_t> first_of_each(
      const std::vector<std::uint32_t>& triangle) const;

  struct Choice {
    std::uint32_t facet;
    bool turned;  // its front is the other facet's back
  };
  // Chooses the first facet of the set whose front the ray meets, or the given facet if there is
  // none.
  //   facet  the first of its set, or a single one
  //   front  true if the ray meets its front
  [[nodiscard]] Choice choose(std::uint32_t facet, bool front) const;

 private:
  struct Facet {
    std::uint32_t number, first;
    bool turned;  // wound against `first`
  };
  std::vector<Facet> same_;  // members of sets, by (first, number)
};

}  // namespace irsig
