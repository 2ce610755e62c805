#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/scene/trace/target.h"

namespace irsig {

// The places of each part's vertices, in trees of boxes: it finds whether some lie above a plane
// without a look at all of them. A slab along the surface cuts each box, so that
// neither the plane of a flat side nor one that touches a curved side finds all boxes sticking out.
// Immutable; made once a target, in n log n.
class PartPlaces {
 public:
  explicit PartPlaces(const Target& target);

  // Returns whether a vertex q of the part has dot(normal, q) > level, q relative to the target's
  // centre [m]. Adds to `tried` how many vertices and boxes were looked at.
  [[nodiscard]] bool any_above(std::size_t part, Vec<Body> normal, double level,
                               std::size_t& tried) const;

 private:
  struct Place {
    Vec<Body> at, normal;  // sum of those of its facets
  };
  struct Box {
    Vec<Body> low, high;
    // bottom <= dot(facing, q) <= top; a facing of 0: no slab.
    Vec<Body> facing;
    double bottom, top;
    std::uint32_t first, last;  // of the places in it
    std::uint32_t right;        // the other half's box, the first's being the next; 0: a leaf
  };
  void add_boxes(std::vector<Place>& places, std::uint32_t first, std::uint32_t last);
  // Returns an upper bound on the height of the box's points along the normal.
  [[nodiscard]] static double highest(const Box& box, Vec<Body> normal);

  std::vector<Vec<Body>> place_;     // one part after the other
  std::vector<Box> box_;             // each part's own one before those of its halves
  std::vector<std::uint32_t> root_;  // [part] in box_; kNone: a part without vertices
  static constexpr std::uint32_t kNone = UINT32_MAX;
};

}  // namespace irsig
