#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/thermal/layers.h"

namespace irsig {

// Finite volumes through a wall, with a node on each face and on each boundary of layers. Private
// to core/thermal.
struct ConductionGrid {
  std::vector<double> capacity_j_m2_k;     // [node], from the outer face
  std::vector<double> conductance_w_m2_k;  // [node - 1], between a node and the next
  std::vector<std::size_t> boundary_node;  // [layer + 1]
  std::vector<double> share_of_next;  // [layer - 1] of a boundary's capacity, the inner layer's

  [[nodiscard]] std::size_t last() const { return conductance_w_m2_k.size(); }
};

// Cells are as deep as heat diffuses: with s = depth / sqrt(diffusivity), of the nearer face, at
// level 0 one covers at most 0.4 sqrt(shortest_step_s) + 0.15 s. Each level halves every cell of
// the one before: node i becomes node 2 i. A layer that does not conduct keeps its heat capacity
// inside, but for a part so small that it counts nowhere and yet leaves no node without a balance.
//   layers  as check_layers accepts
[[nodiscard]] ConductionGrid make_grid(std::span<const Layer> layers, double shortest_step_s,
                                       int level);

}  // namespace irsig
