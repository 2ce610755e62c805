#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/geo/frames.h"

namespace irsig {

// A box along the axes of the land's local frame. [m]
struct LandBox {
  Vec<Enu> low, high;
};

// Boxes in a binary tree. Which boxes a walk visits depends on the ray alone. Immutable; may be
// used by several threads at once.
class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(std::span<const LandBox> box);

  // Calls visit(box, most) for every box that the ray origin + t direction may meet within 0 <= t
  // <= most, with boxes raised as HeightField::first_hit lowers a bent ray. visit returns the
  // distance beyond which boxes no longer matter. Nearer halves of the tree come first.
  template <typename Visit>
  void walk(Vec<Enu> origin, Vec<Enu> direction, double most, double bend_per_m,
            Visit&& visit) const;

  // Calls visit(box) for every box that contains the point.
  template <typename Visit>
  void around(Vec<Enu> point, Visit&& visit) const;

  // Returns an upper bound of z of the boxes that reach into a rectangle; -infinity: none does.
  [[nodiscard]] double highest_m(double west_m, double east_m, double south_m,
                                 double north_m) const;

  [[nodiscard]] std::size_t memory_bytes() const {
    return node_.size() * sizeof(Node) + box_.size() * sizeof(std::uint32_t);
  }

 private:
  struct Node {
    LandBox around;
    std::uint32_t first = 0;  // of the two halves, side by side; of a leaf's boxes
    std::uint32_t count = 0;  // of a leaf's boxes; 0: two halves
  };
  static constexpr std::size_t kDepth = 64;

  // A ray with the inverse of its direction.
  struct Ray {
    std::array<double, 3> origin, direction, inverse;
    double bend_per_m;
    // Returns the distance at which the ray enters a box; more than `most` if it does not.
    [[nodiscard]] double entry(const LandBox& box, double most) const;
  };
  class Builder;

  std::vector<Node> node_;  // the root first
  std::vector<std::uint32_t> box_;
};

inline double BoxTree::Ray::entry(const LandBox& box, double most) const {
  double low[] = {box.low.x, box.low.y, box.low.z};
  double high[] = {box.high.x, box.high.y, box.high.z};
  if (bend_per_m != 0) {
    // Squares of the least and the largest distance of the box from the origin of the frame.
    double least2 = 0, most2 = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      const double least = std::max({0.0, low[k], -high[k]}), far = std::max(-low[k], high[k]);
      least2 += least * least;
      most2 += far * far;
    }
    low[2] += std::min(bend_per_m * least2, bend_per_m * most2);
    high[2] += std::max(bend_per_m * least2, bend_per_m * most2);
  }
  const double never = 2 * most + 1;
  double from = 0, to = most;
  for (std::size_t k = 0; k < 3; ++k) {
    if (direction[k] == 0) {
      if (origin[k] < low[k] || origin[k] > high[k]) return never;
      continue;
    }
    const double a = (low[k] - origin[k]) * inverse[k], b = (high[k] - origin[k]) * inverse[k];
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  return from <= to ? from : never;
}

template <typename Visit>
void BoxTree::walk(Vec<Enu> origin, Vec<Enu> direction, double most, double bend_per_m,
                   Visit&& visit) const {
  if (node_.empty()) return;
  const Ray ray{{origin.x, origin.y, origin.z},
                {direction.x, direction.y, direction.z},
                {1 / direction.x, 1 / direction.y, 1 / direction.z},
                bend_per_m};
  struct Waiting {
    std::uint32_t node;
    double entry;
  };
  std::array<Waiting, kDepth> waiting;
  std::size_t count = 0;
  waiting[count++] = {0, ray.entry(node_[0].around, most)};
  while (count > 0) {
    const Waiting at = waiting[--count];
    if (at.entry > most) continue;
    const Node& node = node_[at.node];
    if (node.count > 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
        most = visit(box_[i], most);
      continue;
    }
    Waiting near{node.first, ray.entry(node_[node.first].around, most)},
        far{node.first + 1, ray.entry(node_[node.first + 1].around, most)};
    if (far.entry < near.entry) std::swap(near, far);
    if (far.entry <= most) waiting[count++] = far;
    if (near.entry <= most) waiting[count++] = near;
  }
}

template <typename Visit>
void BoxTree::around(Vec<Enu> point, Visit&& visit) const {
  walk(point, {0, 0, 1}, 0, 0, [&](std::uint32_t box, double most) {
    visit(box);
    return most;
  });
}

}  // namespace irsig
