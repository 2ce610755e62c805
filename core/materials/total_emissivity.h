#pragma once

#include "absl/status/statusor.h"
#include "core/materials/material_spec.h"

namespace irsig {

// Hemispherical total emissivity: of all that a surface at a temperature emits, relative to a
// blackbody.
struct TotalEmissivity {
  double value;
  // The share of a blackbody's flux at wavelengths that the material's tables cover; beyond them
  // the value at their end is used. 1: no table ends.
  double covered;
};
// Computes the total emissivity from 16 cosines (Gauss and Legendre) and 64 wavelengths of equal
// parts of a blackbody's flux: 1e-3 for tables without narrower lines. Refuses the materials that
// Material::prepare refuses.
//   temperature_k  > 0
[[nodiscard]] absl::StatusOr<TotalEmissivity> total_emissivity(const MaterialSpec& spec,
                                                               double temperature_k);

}  // namespace irsig
