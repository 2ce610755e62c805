#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/materials/material_spec.h"

namespace irsig {

// Roughnesses from a practical mirror to the roughest that the models accept.
inline constexpr std::array kRoughness = {1e-4, 1e-3, 1e-2, 0.1, 0.3, 1.0};

struct HardMaterial {
  std::string name;
  MaterialSpec spec;
  bool bounded = true;  // the form conserves energy for every roughness
};

// Returns one material of every model and form with this roughness. Models without a roughness
// appear for every roughness; a tabulated BRDF cannot be narrower than its grid.
[[nodiscard]] std::vector<HardMaterial> every_material(double roughness);

// Returns the published forms that create energy at the given parameters, and must report it.
[[nodiscard]] std::vector<HardMaterial> gaining_materials();

}  // namespace irsig
