#pragma once

#include <span>

#include "absl/status/status.h"

namespace irsig {

// One layer of a wall. Conductivity 0 is insulation, density or specific heat 0 a layer without
// heat capacity; not both, since no balance would say how warm it is.
struct Layer {
  double thickness_m;           // [1e-9, 1e6]
  double conductivity_w_m_k;    // 0 or [1e-9, 1e12]
  double density_kg_m3;         // [0, 1e9]
  double specific_heat_j_kg_k;  // [0, 1e9]
};

// Layers from the outer face to the inner, one or more. InvalidArgument names the layer, counted
// from 0 at the outer face, and the number that is wrong.
[[nodiscard]] absl::Status check_layers(std::span<const Layer> layers);

}  // namespace irsig
